//! The kinds of figure: what each is called and takes.

use super::Form;
use crate::kernel::Shape;
use crate::parameter::{Absent, Kind, Parameter};

/// A side of a picture in pixels.
const SIDE: Kind = Kind::Count {
    least: 1,
    most: 4096,
};

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
        name: "spread",
        summary: "the estimate at one place against the swept parameter: mean and one standard deviation on each side, simulated and exact, and the truth",
        parameters: &[
            Parameter::required("of", Kind::Text, "the swept estimator"),
            Parameter::required(
                "at",
                Kind::Real,
                "the place: the target nearest to it is shown",
            ),
            Parameter::optional("at-y", Kind::Real, Absent::Unset, "its second coordinate")
                .only_in(2),
        ],
        truth: true,
        replicates: true,
        only: None,
        title: "Estimate against smoothing",
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
        name: "comparison-table",
        summary: "a table in the report: mass, walls, jumps, error against the best width for each place, cost",
        parameters: &[],
        truth: true,
        replicates: true,
        only: Some(1),
        title: "Comparison of density estimation methods",
    },
    Form {
        name: "maps",
        summary: "densities of the plane as colours: the truth, estimates of the first sample, their mean, its error",
        parameters: &[
            Parameter::optional(
                "show",
                Kind::Choices(&["truth", "sample", "mean", "error", "size"]),
                Absent::Unset,
                "what is drawn: the truth, the estimates of the first sample, their mean over replicates, that mean less the truth, how far around each place the first sample was averaged; by default truth (where known) and sample",
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
        name: "unfolded",
        summary: "hits on flat surfaces of a scene, unfolded into one map: the first sample as dots, the truth, the estimate of each estimator",
        parameters: &[Parameter::optional(
            "show",
            Kind::Choices(&["points", "truth", "sample"]),
            Absent::Unset,
            "what is drawn: the points of the first sample, the truth, the estimates from the first sample; by default truth and sample",
        )],
        truth: false,
        replicates: false,
        only: Some(2),
        title: "Unfolded",
    },
    Form {
        name: "camera",
        summary: "pictures of a scene through its camera, lit by each estimator from the hits of the first sample, beside one traced without photons; and maps of what is wrong in each",
        parameters: &[
            Parameter::optional("width", SIDE, Absent::Number(256.0), "pixels in a row"),
            Parameter::optional("height", SIDE, Absent::Number(256.0), "rows of pixels"),
            Parameter::optional(
                "rays",
                Kind::Count { least: 1, most: 16 },
                Absent::Number(2.0),
                "rays for each pixel: so many by so many",
            ),
            Parameter::optional(
                "paths",
                Kind::Count {
                    least: 1,
                    most: 1_000_000,
                },
                Absent::Number(64.0),
                "the picture that judges is traced with so many paths from each place",
            ),
            Parameter::optional(
                "reference",
                Kind::Flag,
                Absent::Flag(false),
                "the picture that judges is lit by the reference instead: without noise where a room is of flat diffuse surfaces, slowly elsewhere",
            ),
        ],
        truth: false,
        replicates: false,
        only: Some(2),
        title: "Seen by the camera",
    },
    Form {
        name: "section",
        summary: "estimates of the first sample and the truth along a straight line through the plane",
        parameters: &[
            Parameter::required("from-x", Kind::Real, "where the line begins, first axis"),
            Parameter::required("from-y", Kind::Real, "where the line begins, second axis"),
            Parameter::required("to-x", Kind::Real, "where the line ends, first axis"),
            Parameter::required("to-y", Kind::Real, "where the line ends, second axis"),
            Parameter::optional(
                "show",
                Kind::Choices(&[
                    "truth",
                    "sample",
                    "mean",
                    "band",
                    "error",
                    "expected-error",
                    "size",
                ]),
                Absent::Unset,
                "what is drawn: the truth, the estimates of the first sample, their mean over replicates, ± one standard deviation about it; or apart from those the root mean squared error over replicates, the error that an estimator expects of itself on the first sample, or how far around each place it averaged; by default truth and sample",
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
        only: Some(2),
        title: "Cross-section",
    },
];
