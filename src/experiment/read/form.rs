//! The forms of a claim: what each takes.
//!
//! A claim that nothing could contradict is none, so what decides how much it lets pass has limits: the confidence, the factors, and the margins, some of
//! which `claim` checks because they depend on the value that is claimed.

use crate::kernel::{Shape, Symmetry};
use crate::parameter::{Absent, Kind, Parameter};

const OF: Parameter = Parameter::required("of", Kind::Text, "the estimator");
const CONFIDENCE: Parameter = Parameter::optional(
    "confidence",
    Kind::Range(0.9, 0.9999),
    Absent::Number(0.99),
    "the confidence of the interval: below 0.9 chance shows what is not there, above 0.9999 the interval lets everything agree",
);
/// As a share of what is expected: at one half and more, "equal" would mean "within a factor of two".
const WITHIN: Kind = Kind::Between(0.0, 0.5);
const MARGIN: Parameter = Parameter::optional(
    "margin",
    Kind::Positive,
    Absent::Unset,
    "how far off is still equal, in the unit of the measure",
);

const OTHER_SOURCE: Parameter = Parameter::optional(
    "other-source",
    Kind::Text,
    Absent::Unset,
    "the source of the number that is compared with; the claim's own by default",
);
const OTHER_DRAWS: Parameter = Parameter::optional(
    "other-draws",
    Kind::Count {
        least: 1,
        most: super::DRAWS,
    },
    Absent::Unset,
    "the sample size of the number that is compared with; the claim's own by default",
);

/// A form of statement: the key that tells it from the others, and what it takes.
pub(crate) struct Form {
    pub(crate) key: &'static str,
    pub(crate) parameters: &'static [Parameter],
}

/// The forms that any measure takes.
pub(crate) const ANY: &[Form] = &[
    Form {
        key: "below",
        parameters: &[
            OF,
            Parameter::required("below", Kind::Text, "the estimator that is worse"),
            Parameter::optional(
                "by",
                Kind::Range(0.5, 1e9),
                Absent::Number(1.0),
                "at least by this factor; below 1: at most worse by its reciprocal",
            ),
            OTHER_SOURCE,
            OTHER_DRAWS,
            CONFIDENCE,
        ],
    },
    Form {
        key: "equals",
        parameters: &[
            OF,
            Parameter::optional(
                "over",
                Kind::Text,
                Absent::Unset,
                "the estimator to divide by, or \"minimum\": the least MISE of any bandwidth (exact-mise only)",
            ),
            Parameter::required("equals", Kind::Real, "the expected value"),
            Parameter::optional(
                "within",
                WITHIN,
                Absent::Unset,
                "how far off is still equal, as a share of the expected value",
            ),
            MARGIN,
            OTHER_SOURCE,
            OTHER_DRAWS,
            CONFIDENCE,
        ],
    },
    Form {
        key: "agrees-with",
        parameters: AGREES,
    },
];

/// The further forms of `modes`.
pub(crate) const MODES: &[Form] = &[
    Form {
        key: "median",
        parameters: &[
            OF,
            Parameter::required(
                "median",
                Kind::Count {
                    least: 0,
                    most: 1_000_000,
                },
                "the expected median: both ends of the interval for it must be this number",
            ),
            CONFIDENCE,
        ],
    },
    Form {
        key: "count",
        parameters: &[
            OF,
            Parameter::required(
                "count",
                Kind::Count {
                    least: 0,
                    most: 1_000_000,
                },
                "how many modes",
            ),
            Parameter::required(
                "share",
                Kind::Fraction,
                "the expected share of the replicates",
            ),
            Parameter::required(
                "margin",
                Kind::Between(0.0, 0.5),
                "how far off is still equal: the whole interval for the share must lie inside, and half of all shares outside",
            ),
            CONFIDENCE,
        ],
    },
];

/// `best`.
pub(crate) const BEST: &[Parameter] = &[
    Parameter::required("of", Kind::Text, "the swept estimator"),
    Parameter::required(
        "near",
        Kind::Choice(&["oracle", "exact"]),
        "the exact optimum over the whole line or plane, or that of the exact values of the sweep itself over the experiment's cells",
    ),
    Parameter::required("within", WITHIN, "how near, as a share of the optimum"),
];

/// `regret`.
pub(crate) const REGRET: &[Parameter] = &[
    Parameter::required("of", Kind::Text, "the estimator"),
    Parameter::required(
        "over",
        Kind::Text,
        "the estimator whose ISE on the same sample is divided by, such as one with bandwidth = \"oracle-ise\"",
    ),
    Parameter::required(
        "median",
        Kind::Positive,
        "the expected median over the replicates",
    ),
    Parameter::required("margin", Kind::Positive, "how far off is still equal"),
    Parameter::optional(
        "below",
        Kind::Text,
        Absent::Unset,
        "an estimator that is worse on more than half of the samples",
    ),
    CONFIDENCE,
];

/// `everywhere`, and `agrees-with` of a measure.
pub(crate) const AGREES: &[Parameter] = &[
    Parameter::optional(
        "of",
        Kind::Texts,
        Absent::Unset,
        "the estimators; all by default",
    ),
    Parameter::required("agrees-with", Kind::Choice(&["exact"]), "the exact value"),
    CONFIDENCE,
];

/// `coverage`.
pub(crate) const COVERAGE: &[Parameter] = &[
    OF,
    Parameter::required(
        "at",
        Kind::Real,
        "the place: the target nearest to it counts",
    ),
    Parameter::optional("at-y", Kind::Real, Absent::Unset, "its second coordinate").only_in(2),
    Parameter::optional(
        "target",
        Kind::Choice(&["mean", "truth"]),
        Absent::Word("mean"),
        "what the interval should hold: the mean of the estimate, which it is about, or the truth",
    ),
    Parameter::required(
        "equals",
        Kind::Fraction,
        "the expected share of intervals that hold it",
    ),
    Parameter::required(
        "margin",
        Kind::Between(0.0, 0.25),
        "how far off is still equal: the whole interval for the share must lie inside",
    ),
    CONFIDENCE,
];

/// `slope`.
pub(crate) const SLOPE: &[Parameter] = &[
    OF,
    Parameter::optional(
        "measure",
        Kind::Choice(&[
            "mise",
            "miae",
            "mire",
            "exact-mise",
            "exact-bias2",
            "exact-variance",
        ]),
        Absent::Word("mise"),
        "what falls as samples grow",
    ),
    Parameter::optional(
        "equals",
        Kind::Real,
        Absent::Unset,
        "the expected exponent, below 0 for what falls",
    ),
    Parameter::optional(
        "agrees-with",
        Kind::Choice(&["exact"]),
        Absent::Unset,
        "instead of a number: the slope of the exact values at the same sizes",
    ),
    Parameter::required(
        "margin",
        Kind::Between(0.0, 0.25),
        "how far off is still equal: the whole interval for the slope must lie inside",
    ),
    CONFIDENCE,
];

/// `oracle`.
pub(crate) const ORACLE: &[Parameter] = &[
    Parameter::required(
        "quantity",
        Kind::Choice(&[
            "h_mise",
            "mise",
            "bias2",
            "variance",
            "h_amise",
            "amise",
            "amise_over_mise",
        ]),
        "which figure of the theory",
    ),
    Parameter::optional(
        "kernel",
        Kind::Choice(&Shape::NAMES),
        Absent::Word("gaussian"),
        "the kernel",
    ),
    Parameter::optional(
        "symmetry",
        Kind::Choice(&Symmetry::NAMES),
        Absent::Word("product"),
        "in the plane: a kernel of each axis or one of the distance",
    ),
    Parameter::required("equals", Kind::Positive, "the expected value"),
    Parameter::optional(
        "digits",
        Kind::Count { least: 1, most: 12 },
        Absent::Number(4.0),
        "how many significant digits must agree",
    ),
];

/// Keys beside the statement.
pub(crate) const COMMON: &[Parameter] = &[
    Parameter::optional(
        "says",
        Kind::Text,
        Absent::Unset,
        "the claim in words; made from the statement by default",
    ),
    Parameter::optional(
        "draws",
        Kind::Count {
            least: 1,
            most: super::DRAWS,
        },
        Absent::Unset,
        "the sample size it is about, one of the experiment's; each of them by default",
    ),
    Parameter::optional(
        "source",
        Kind::Text,
        Absent::Unset,
        "the source it is about; each of them by default",
    ),
    Parameter::optional(
        "region",
        Kind::Text,
        Absent::Unset,
        "the region it is about; the whole grid by default",
    ),
];
