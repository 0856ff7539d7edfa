//! Arguments, and estimators in them.

use super::{KERNEL, bad, check};
use crate::support::Bench;

#[test]
fn estimators_in_fault() {
    let on = |what, estimator: &'static str, says: &[&'static str]| {
        bad(what, &["estimate", "x.csv", "-e", estimator], 2, says).with("x.csv", "x\n1\n2\n4\n")
    };
    check(&[
        on("nothing", "", &["--estimator"]),
        on("no TOML", "kernel = {", &["--estimator:1:"]),
        on(
            "unknown kind",
            "kernl = { bandwidth = 1 }",
            &["--estimator:1:1:", "did you mean `kernel`?"],
        ),
        on(
            "unknown key",
            "kernel = { bandwith = 1 }",
            &["--estimator:1:12:", "did you mean `bandwidth`?"],
        ),
        on(
            "unknown word",
            "kernel = { bandwidth = \"silvermann\" }",
            &["--estimator:1:24:", "did you mean `silverman`?"],
        ),
        on(
            "unknown kernel",
            "kernel = { bandwidth = 1, shape = \"gausian\" }",
            &["--estimator:1:35:", "did you mean `gaussian`?"],
        ),
        on(
            "zero",
            "kernel = { bandwidth = 0 }",
            &["--estimator:1:24:", "above 0"],
        ),
        on(
            "negative",
            "kernel = { bandwidth = -1.5 }",
            &["--estimator:1:24:", "above 0"],
        ),
        on(
            "nan",
            "kernel = { bandwidth = nan }",
            &["--estimator:1:24:", "above 0"],
        ),
        on(
            "inf",
            "kernel = { bandwidth = inf }",
            &["--estimator:1:24:", "above 0"],
        ),
        on(
            "too large",
            "kernel = { bandwidth = 1e400 }",
            &["--estimator:1:24:"],
        ),
        on(
            "wrong type",
            "kernel = { bandwidth = true }",
            &["--estimator:1:24:", "above 0"],
        ),
        on(
            "a sweep",
            "kernel = { bandwidth = [0.1, 0.2] }",
            &["one is wanted here"],
        ),
        on("missing", "kernel = {}", &["--estimator:1:", "`bandwidth`"]),
        on(
            "two kinds",
            "kernel = { bandwidth = 1 }\nnormal = {}",
            &["--estimator:2:1:"],
        ),
        on(
            "a key twice",
            "kernel = { bandwidth = 1, bandwidth = 2 }",
            &["--estimator:1:"],
        ),
        on(
            "a count too large",
            "shifted-histogram = { width = 1, shifts = 9223372036854775807 }",
            &["--estimator:1:43:", "from 1 to "],
        ),
        on(
            "braces",
            "{ kernel = { bandwidth = 0 } }",
            &["--estimator:1:26:", "above 0"],
        ),
    ]);
    let deep = "[".repeat(100_000);
    let bench = Bench::new().with("x.csv", "1\n2\n");
    bench
        .run(&["estimate", "x.csv", "-e", &format!("a = {deep}")])
        .ends_with(2)
        .says("--estimator:1:")
        .prints_nothing();
}

#[test]
fn arguments_in_fault() {
    let on = |what, options: &[&'static str], says: &[&'static str]| {
        let arguments = [&["estimate", "x.csv", "-e", KERNEL], options].concat();
        bad(what, &arguments, 2, says).with("x.csv", "x\n1\n2\n4\n")
    };
    check(&[
        on(
            "grid of nan",
            &["--grid", "nan:1:5"],
            &["--grid", "LO:HI:N"],
        ),
        on(
            "grid backwards",
            &["--grid", "1:0:5"],
            &["--grid", "LO < HI"],
        ),
        on(
            "grid without cells",
            &["--grid", "0:1:0"],
            &["--grid", "whole number from 1"],
        ),
        on(
            "grid of 10^12 cells",
            &["--grid", "0:1:1000000000000"],
            &["--grid", "at most 268435456"],
        ),
        on(
            "grid without end",
            &["--grid", "0:inf:5"],
            &["--grid", "LO:HI:N"],
        ),
        on(
            "grid of one number",
            &["--grid", "7"],
            &["--grid", "such as -3:3:512"],
        ),
        on(
            "grid thinner than numbers",
            &["--grid", "1e17:100000000000000100:1000"],
            &["--grid", "thinner"],
        ),
        on(
            "grid and targets",
            &["--grid", "0:1:5", "--at", "x.csv"],
            &["cannot be used with"],
        ),
        on(
            "domain backwards",
            &["--domain", "5:0"],
            &["--domain", "LO < HI"],
        ),
        on(
            "domain of words",
            &["--domain", "low:high"],
            &["--domain", "such as 0:1"],
        ),
        on(
            "no threads",
            &["--threads", "0"],
            &["--threads", "from 1 to 1024"],
        ),
        on(
            "absurd threads",
            &["--threads", "9223372036854775807"],
            &["--threads", "from 1 to 1024"],
        ),
        on(
            "threads of nan",
            &["--threads", "nan"],
            &["--threads", "from 1 to 1024"],
        ),
        on(
            "no choice of engines",
            &["--engine", "fastest"],
            &["--engine"],
        ),
        on(
            "misspelt option",
            &["--gird", "0:1:5"],
            &["--gird", "--grid"],
        ),
        on(
            "two outputs",
            &["-o", "a.csv", "-o", "b.csv"],
            &["cannot be used multiple times"],
        ),
        bad("no command", &[], 2, &["Usage: lab"]),
        bad(
            "misspelt command",
            &["estmate"],
            2,
            &["estmate", "'estimate'"],
        ),
        bad("no estimator", &["estimate", "x.csv"], 2, &["--estimator"]),
        bad(
            "unknown list",
            &["list", "kernel"],
            2,
            &["kernel", "kernels"],
        ),
        bad("unknown shell", &["completions", "bsh"], 2, &["bash"]),
        bad(
            "both from stdin",
            &["estimate", "-", "--at", "-", "-e", KERNEL],
            2,
            &["cannot both come from stdin"],
        ),
    ]);
}

#[test]
fn densities_kernels_and_counts_in_fault() {
    let sample = |what, density, n, says: &[&'static str]| {
        bad(what, &["sample", "--density", density, "--n", n], 2, says)
    };
    let oracle = |what, options: &[&'static str], says: &[&'static str]| {
        bad(
            what,
            &[&["oracle", "--density", "claw", "--n", "100"], options].concat(),
            2,
            says,
        )
    };
    check(&[
        sample(
            "misspelt density",
            "bimodel",
            "5",
            &[
                "no density \"bimodel\"; did you mean \"bimodal\"?",
                "allowed are ",
            ],
        ),
        sample(
            "unknown density",
            "cauchy",
            "5",
            &["no density \"cauchy\"", "mw-1, mw-2"],
        ),
        sample(
            "needs parameters",
            "normal-mixture",
            "5",
            &["needs parameters", "--density 'normal-mixture = { "],
        ),
        sample(
            "a parameter missing",
            "normal-mixture = {}",
            "5",
            &[
                "--density:1:1: error",
                "`normal-mixture` needs `components`",
            ],
        ),
        sample(
            "a parameter in fault",
            "beta = { a = 2, b = -1 }",
            "5",
            &["--density:1:21: error", "above 0"],
        ),
        sample(
            "the same in braces",
            "{ beta = { a = 2, b = -1 } }",
            "5",
            &["--density:1:23: error", "above 0"],
        ),
        sample(
            "misspelt kind",
            "bta = { a = 2, b = 1 }",
            "5",
            &["--density:1:1: error", "did you mean `beta`?"],
        ),
        sample(
            "misspelt parameter",
            "exponential = { rte = 2 }",
            "5",
            &["--density:1:17: error", "did you mean `rate`?"],
        ),
        sample("no kind", "name = 'x'", "5", &["names no kind of density"]),
        sample(
            "two kinds",
            "uniform = {}, beta = { a = 1, b = 2 }",
            "5",
            &["--density:1:"],
        ),
        sample(
            "never closed",
            "{ beta = { a = 2, b = 1 }",
            "5",
            &["--density:1:"],
        ),
        sample(
            "more than a density",
            "uniform = {} }\nseed = { a = 1",
            "5",
            &["--density:"],
        ),
        sample(
            "only braces",
            "{}",
            "5",
            &["--density:1:1", "names no kind"],
        ),
        bad(
            "oracle of a density in fault",
            &[
                "oracle",
                "--density",
                "uniform = { low = 1, high = 0 }",
                "--n",
                "100",
            ],
            2,
            &["--density:1:"],
        ),
        sample("n = 0", "claw", "0", &["--n", "whole number from 1"]),
        sample("n = -1", "claw", "-1", &["--n"]),
        sample("n = nan", "claw", "nan", &["--n", "whole number from 1"]),
        sample("n = 1.5", "claw", "1.5", &["--n", "whole number from 1"]),
        sample(
            "n = 1e400",
            "claw",
            "1e400",
            &["--n", "whole number from 1"],
        ),
        sample(
            "n = 10^12",
            "claw",
            "1000000000000",
            &["at most 1000000000", "18.2 TiB"],
        ),
        sample(
            "n = 2^63 - 1",
            "claw",
            "9223372036854775807",
            &["at most 1000000000"],
        ),
        bad(
            "seed",
            &["sample", "--density", "claw", "--n", "5", "--seed=-1"],
            2,
            &["--seed"],
        ),
        bad(
            "seed of nan",
            &["sample", "--density", "claw", "--n", "5", "--seed", "nan"],
            2,
            &["--seed"],
        ),
        oracle(
            "misspelt kernel",
            &["--kernel", "epanechnikow"],
            &["did you mean \"epanechnikov\"?", "allowed are "],
        ),
        oracle(
            "h = 0",
            &["--bandwidth", "0"],
            &["--bandwidth", "finite number above 0"],
        ),
        oracle(
            "h < 0",
            &["--bandwidth", "-0.5"],
            &["--bandwidth", "finite number above 0"],
        ),
        oracle(
            "h = nan",
            &["--bandwidth", "nan"],
            &["--bandwidth", "finite number above 0"],
        ),
        oracle(
            "h = inf",
            &["--bandwidth", "inf"],
            &["--bandwidth", "finite number above 0"],
        ),
        oracle(
            "h = 1e400",
            &["--bandwidth", "1e400"],
            &["--bandwidth", "finite number above 0"],
        ),
        oracle(
            "h below all numbers",
            &["--bandwidth", "5e-324"],
            &["--bandwidth 5e-324", "beyond what numbers can hold"],
        ),
    ]);
}
