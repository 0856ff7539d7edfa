//! The kinds of figure: what each is called and takes.

use super::Form;
use crate::kernel::Shape;
use crate::parameter::{Absent, Kind, Parameter};

/// Every kind of figure.
pub(crate) const FORMS: &[Form] = &[
    Form {
        name: "curves",
        summary: "estimates of the first sample over the truth",
        parameters: &[
            Parameter::optional(
                "show",
                Kind::Choices(&["truth", "sample", "mean", "band", "rug"]),
                Absent::Unset,
                "what is drawn: the truth, the estimates of the first sample, their mean and their band of one standard deviation over replicates, the data; by default truth (where known) and sample",
            ),
            Parameter::optional(
                "panels",
                Kind::Flag,
                Absent::Flag(false),
                "one small panel an estimator instead of all in one",
            ),
        ],
        truth: false,
        replicates: false,
        only: Some(1),
        title: "Estimates",
    },
    Form {
        name: "errors",
        summary: "a measure of each estimator with its interval, beside the exact value",
        parameters: &[Parameter::optional(
            "measure",
            Kind::Choice(&["mise", "miae", "mire"]),
            Absent::Word("mise"),
            "the measure",
        )],
        truth: true,
        replicates: true,
        only: None,
        title: "Errors",
    },
    Form {
        name: "modes",
        summary: "how many modes the estimates have over the replicates",
        parameters: &[],
        truth: false,
        replicates: true,
        only: None,
        title: "Number of modes",
    },
    Form {
        name: "sweep",
        summary: "MISE, bias² and variance against the swept parameter, simulated and exact",
        parameters: &[
            Parameter::required("of", Kind::Text, "the swept estimator"),
            Parameter::optional(
                "mark",
                Kind::Choices(&[
                    "h_mise",
                    "h_amise",
                    "amise",
                    "silverman",
                    "normal-reference",
                    "scott",
                ]),
                Absent::Unset,
                "vertical markers, and `amise` for the curve of the leading terms; none by default",
            ),
        ],
        truth: true,
        replicates: true,
        only: None,
        title: "Error against smoothing",
    },
    Form {
        name: "convergence",
        summary: "a measure against the sample size, simulated and exact, with the slope of each estimator",
        parameters: &[Parameter::optional(
            "measure",
            Kind::Choice(&["mise", "miae", "mire"]),
            Absent::Word("mise"),
            "the measure",
        )],
        truth: true,
        replicates: true,
        only: None,
        title: "Convergence",
    },
    Form {
        name: "coverage",
        summary: "how often the interval about the estimate at each place holds the mean of the estimate and the truth",
        parameters: &[],
        truth: true,
        replicates: true,
        only: Some(1),
        title: "Coverage",
    },
    Form {
        name: "local-bandwidth",
        summary: "the best bandwidth at each place beside the best for all places, exactly and by leading terms for large samples",
        parameters: &[Parameter::optional(
            "kernel",
            Kind::Choice(&Shape::NAMES),
            Absent::Word("gaussian"),
            "the kernel",
        )],
        truth: true,
        replicates: false,
        only: Some(1),
        title: "Best bandwidth at each place",
    },
    Form {
        name: "densities",
        summary: "one small panel a source: truth and estimates of the first sample",
        parameters: &[],
        truth: true,
        replicates: false,
        only: Some(1),
        title: "Densities",
    },
    Form {
        name: "efficiency",
        summary: "measured and theoretical efficiency of each kernel",
        parameters: &[],
        truth: true,
        replicates: true,
        only: Some(1),
        title: "Efficiency",
    },
    Form {
        name: "uncertainty",
        summary: "the true root mean squared error and what each [[uncertainty]] says of it, along a line",
        parameters: &[
            Parameter::optional(
                "at",
                Kind::Real,
                Absent::Unset,
                "in the plane, where the line crosses the second axis; in its middle by default",
            )
            .only_in(2),
            Parameter::optional(
                "calibrated",
                Kind::Flag,
                Absent::Flag(false),
                "local differences are multiplied by their fitted factor M",
            ),
        ],
        truth: true,
        replicates: true,
        only: None,
        title: "Estimated and true error",
    },
    Form {
        name: "maps",
        summary: "densities of the plane as colours: the truth, estimates of the first sample, their mean, its error",
        parameters: &[
            Parameter::optional(
                "show",
                Kind::Choices(&["truth", "sample", "mean", "error"]),
                Absent::Unset,
                "what is drawn: the truth, the estimates of the first sample, their mean over replicates, that mean less the truth; by default truth (where known) and sample",
            ),
            Parameter::optional(
                "levels",
                Kind::Flag,
                Absent::Flag(false),
                "lines at round values over the colours",
            ),
        ],
        truth: false,
        replicates: false,
        only: Some(2),
        title: "Maps",
    },
    Form {
        name: "section",
        summary: "estimates of the first sample and the truth along a straight line through the plane",
        parameters: &[
            Parameter::required("from-x", Kind::Real, "where the line begins, first axis"),
            Parameter::required("from-y", Kind::Real, "where the line begins, second axis"),
            Parameter::required("to-x", Kind::Real, "where the line ends, first axis"),
            Parameter::required("to-y", Kind::Real, "where the line ends, second axis"),
        ],
        truth: false,
        replicates: false,
        only: Some(2),
        title: "Cross-section",
    },
];
