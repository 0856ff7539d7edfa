//! Whatever is wrong with what `lab` is given, it says where, says what would be right, and leaves nothing half-done behind.
//!
//! Each row: what is wrong, the files, the arguments, the exit code (2 bad input, 3 the system refused) and what the message must have.
#![allow(clippy::unwrap_used)]
#![allow(clippy::too_many_lines, reason = "tables, one row a case")]

mod support;

use std::fs::File;
use support::Bench;

struct Bad {
    what: &'static str,
    files: Vec<(&'static str, Vec<u8>)>,
    arguments: Vec<&'static str>,
    code: i32,
    says: Vec<&'static str>,
}

fn bad(what: &'static str, arguments: &[&'static str], code: i32, says: &[&'static str]) -> Bad {
    Bad {
        what,
        files: Vec::new(),
        arguments: arguments.to_vec(),
        code,
        says: says.to_vec(),
    }
}

impl Bad {
    fn with(mut self, name: &'static str, bytes: impl AsRef<[u8]>) -> Self {
        self.files.push((name, bytes.as_ref().to_vec()));
        self
    }

    /// What is wrong with the answer, if anything.
    fn fault(&self) -> Option<String> {
        let mut bench = Bench::new();
        for (name, bytes) in &self.files {
            bench = bench.with(name, bytes);
        }
        let before = bench.listing();
        let outcome = bench.run(&self.arguments);
        let missing = self
            .says
            .iter()
            .find(|fragment| !outcome.stderr.contains(**fragment));
        let fault = if outcome.code != Some(self.code) {
            format!("not exit code {}", self.code)
        } else if let Some(fragment) = missing {
            format!("does not say {fragment:?}")
        } else if !outcome.stdout.is_empty() {
            "prints something".to_owned()
        } else if outcome.stderr.len() > 20_000 {
            "says too much".to_owned()
        } else if bench.listing() != before {
            format!("leaves {:?}", bench.listing())
        } else {
            return None;
        };
        Some(format!("== {}: {fault}\n{outcome}", self.what))
    }
}

fn check(rows: &[Bad]) {
    let faults: Vec<String> = rows.iter().filter_map(Bad::fault).collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

const KERNEL: &str = "kernel = { bandwidth = 0.3 }";

/// `lab estimate x.csv` on this text.
fn data(what: &'static str, text: impl AsRef<[u8]>, says: &[&'static str]) -> Bad {
    bad(
        what,
        &["estimate", "x.csv", "--column", "x", "-e", KERNEL],
        2,
        says,
    )
    .with("x.csv", text)
}

#[test]
fn tables_in_fault() {
    check(&[
        data("empty", "", &["x.csv: the file is empty"]),
        data("header only", "x,y\n", &["x.csv: there are no data"]),
        data(
            "blank lines only",
            "\n\r\n\n",
            &["x.csv: there are no data"],
        ),
        data(
            "short row",
            "x,y\n1,2\n3\n",
            &["x.csv:3:1:", "1 cells, but line 1 has 2"],
        ),
        data(
            "long row",
            "x,y\n1,2,3\n",
            &["x.csv:2:3:", "3 cells, but line 1 has 2"],
        ),
        data(
            "empty cell",
            "x,y\n1,2\n,4\n",
            &["x.csv:3:1:", "missing", "\"x\""],
        ),
        data("NA", "y,x\n1,NA\n", &["x.csv:2:2:", "missing (\"NA\")"]),
        data("nan", "x\nnan\n", &["x.csv:2:1:", "missing"]),
        data(
            "inf",
            "x\n1\ninf\n",
            &["x.csv:3:1:", "\"inf\" is not a finite number"],
        ),
        data(
            "too large",
            "x\n1e400\n",
            &["x.csv:2:1:", "is not a finite number", "1.8e308"],
        ),
        data(
            "word",
            "x\n1\ntwo\n",
            &["x.csv:3:1: \"two\" is not a number in column \"x\""],
        ),
        data(
            "decimal comma",
            "x;y\n1,5;2\n",
            &["x.csv:2:1:", "the decimal mark is a point"],
        ),
        data(
            "with BOM and CRLF the line is still right",
            "\u{feff}x\r\n1\r\n\r\noops\r\n",
            &["x.csv:4:1: \"oops\""],
        ),
        data(
            "other column",
            "minutes\n1\n",
            &["x.csv:1: no column \"x\"", "the columns are \"minutes\""],
        ),
        data(
            "misspelt column",
            "X_,xx\n1,2\n",
            &["no column \"x\"", "the columns are \"X_\", \"xx\""],
        ),
        data(
            "two columns of one name",
            "x,x\n1,2\n",
            &["stands over columns 1 and 2", "give the number"],
        ),
        data(
            "open quote",
            "x,y\n1,\"2\n3,4\n",
            &["x.csv:2:", "the quote that opens this cell is never closed"],
        ),
        data(
            "bad UTF-8",
            b"x\n1\n\xff\xfe\n",
            &["x.csv:3:1:", "is not UTF-8 text"],
        ),
        data(
            "binary",
            b"\x00\x01\x02\x03",
            &["x.csv: the file is binary"],
        ),
        data(
            "gzip",
            b"\x1f\x8b\x08\x00\x00",
            &["x.csv: the file is gzip", "gunzip -c"],
        ),
        data(
            "xlsx",
            b"PK\x03\x04\x14\x00",
            &["x.csv: the file is zip", "unpack it first"],
        ),
        data(
            "UTF-16",
            b"\xff\xfex\x00\n\x00",
            &["x.csv: the file is UTF-16", "UTF-8"],
        ),
        data(
            "a terminal is not painted",
            "\u{1b}[31mred\n1\n",
            &["\\u{1b}[31mred"],
        ),
    ]);
}

#[test]
fn columns_weights_and_domains_in_fault() {
    let on = |what, text: &str, options: &[&'static str], says: &[&'static str]| {
        let arguments = [&["estimate", "x.csv", "-e", KERNEL], options].concat();
        bad(what, &arguments, 2, says).with("x.csv", text)
    };
    check(&[
        on(
            "which column",
            "a,b\n1,2\n",
            &[],
            &["name the column to read; the columns are \"a\", \"b\""],
        ),
        on(
            "near miss",
            "minutes,b\n1,2\n",
            &["-c", "minute"],
            &["did you mean \"minutes\"?"],
        ),
        on(
            "number beyond",
            "a,b\n1,2\n",
            &["-c", "3"],
            &["no column \"3\""],
        ),
        on(
            "number zero",
            "1,2\n3,4\n",
            &["-c", "0"],
            &["no column \"0\"", "the columns are 1 to 2"],
        ),
        on(
            "huge number",
            "a\n1\n",
            &["-c", "99999999999999999999"],
            &["no column"],
        ),
        on(
            "column and weight",
            "a,b\n1,2\n",
            &["-c", "a", "-w", "a"],
            &["both as data and as weight"],
        ),
        on(
            "no such weight",
            "a,b\n1,2\n",
            &["-c", "a", "-w", "c"],
            &["no column \"c\""],
        ),
        on(
            "negative weight",
            "a,w\n1,1\n2,-1\n",
            &["-c", "a", "-w", "w"],
            &["x.csv:3:2: the weight -1 is not allowed"],
        ),
        on(
            "weights of zero",
            "a,w\n1,0\n2,0\n",
            &["-c", "a", "-w", "w"],
            &["the weights sum to 0"],
        ),
        on(
            "weights too large",
            "a,w\n1,1e308\n2,1e308\n",
            &["-c", "a", "-w", "w"],
            &["the weights sum to inf"],
        ),
        on(
            "outside the domain",
            "a\n0.5\n1.5\n",
            &["--domain", "0:1"],
            &["x.csv:3:1: 1.5 lies outside the domain, 0 to 1"],
        ),
    ]);
}

/// A `.npy` with this header and payload.
fn array(header: &str, payload: &[u8]) -> Vec<u8> {
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(payload);
    bytes
}

#[test]
fn arrays_in_fault() {
    let npy = |what, bytes: Vec<u8>, says: &[&'static str]| {
        bad(what, &["estimate", "x.npy", "-e", KERNEL], 2, says).with("x.npy", bytes)
    };
    let f8 =
        |shape: &str| format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}\n");
    let numbers = |x: &[f64]| -> Vec<u8> { x.iter().flat_map(|x| x.to_le_bytes()).collect() };
    check(&[
        npy(
            "cut short",
            array(&f8("(3,)"), &numbers(&[1.0])),
            &["x.npy: the file is cut short", "3 rows (24 bytes)"],
        ),
        npy(
            "10^12 rows",
            array(&f8("(1000000000000,)"), &numbers(&[1.0])),
            &["x.npy: the file is cut short", "7.3 TiB"],
        ),
        npy(
            "shape beyond any file",
            array(&f8("(9999999999, 9999999999)"), &[]),
            &["its shape is larger than any file"],
        ),
        npy(
            "nesting",
            array(&"[".repeat(60_000), &[]),
            &["nested too deeply"],
        ),
        npy(
            "integers",
            array(
                "{'descr': '<i8', 'fortran_order': False, 'shape': (1,), }\n",
                &[0; 8],
            ),
            &["'<i8'", "astype('<f8')"],
        ),
        npy(
            "three axes",
            array(&f8("(1, 1, 1)"), &numbers(&[1.0])),
            &["shape [1, 1, 1]"],
        ),
        npy(
            "NaN",
            array(&f8("(2,)"), &numbers(&[1.0, f64::NAN])),
            &["x.npy:2:1: NaN is not a finite number"],
        ),
        npy("no rows", array(&f8("(0,)"), &[]), &["there are no data"]),
        npy(
            "garbage",
            array("{'descr'", &[]),
            &["the header of the array is damaged"],
        ),
    ]);
}

#[cfg(target_os = "linux")]
#[test]
fn an_array_larger_than_memory_is_refused_before_it_is_read() {
    let bench = Bench::new().with(
        "x.npy",
        array(
            "{'descr': '<f8', 'fortran_order': False, 'shape': (1000000000000,), }\n",
            &[],
        ),
    );
    // eight terabytes that take no room on the disk, where the file system can do it
    let file = File::options()
        .write(true)
        .open(bench.path("x.npy"))
        .unwrap();
    if file.set_len(8_000_000_001_000).is_err() {
        println!("skipped: no sparse files of this size here");
        return;
    }
    let refused = bench
        .run(&["estimate", "x.npy", "-e", KERNEL])
        .ends_with(2)
        .prints_nothing();
    refused.says("x.npy: too large: 0 rows of data so far and 1000000000000 more: 7.3 TiB of memory would be needed, and ");
}

#[test]
fn data_that_no_estimate_can_be_made_of() {
    let on = |what, text: &'static str, estimator: &'static str, says: &[&'static str]| {
        bad(what, &["estimate", "x.csv", "-e", estimator], 2, says).with("x.csv", text)
    };
    let silverman = "kernel = { bandwidth = \"silverman\" }";
    check(&[
        on(
            "one point",
            "x\n1\n",
            silverman,
            &["--estimator: ", "the data have no spread", "give a number"],
        ),
        on(
            "constant",
            "x\n7\n7\n7\n",
            silverman,
            &["all 3 points are at 7", "give a number"],
        ),
        on(
            "constant, scott",
            "x\n7\n7\n7\n",
            "kernel = { bandwidth = \"scott\" }",
            &["no spread"],
        ),
        on(
            "constant, histogram",
            "x\n7\n7\n7\n",
            "histogram = { width = \"scott\" }",
            &["no spread"],
        ),
        on(
            "constant, normal",
            "x\n7\n7\n7\n",
            "normal = {}",
            &["--estimator: "],
        ),
        on(
            "oracle without truth",
            "x\n1\n2\n",
            "kernel = { bandwidth = \"oracle\" }",
            &["--estimator: `bandwidth`", "not known", "give a number"],
        ),
        on(
            "bandwidth below all numbers",
            "x\n1\n2\n",
            "kernel = { bandwidth = 1e-320 }",
            &["--estimator:1:24:", "too small"],
        ),
        on(
            "grid thinner than numbers",
            "x\n1e300\n1e300\n",
            KERNEL,
            &["--grid LO:HI:N"],
        ),
        on(
            "range beyond numbers",
            "x\n-1.7e308\n1.7e308\n",
            KERNEL,
            &["--grid LO:HI:N"],
        ),
    ]);
}

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

#[test]
fn files_that_the_system_does_not_give() {
    let on = |what, arguments: &[&'static str], says: &[&'static str]| {
        bad(what, arguments, 3, says).with("points.csv", "x\n1\n2\n4\n")
    };
    check(&[
        on(
            "missing",
            &["estimate", "nowhere.csv", "-e", KERNEL],
            &["nowhere.csv: No such file"],
        ),
        on(
            "misspelt",
            &["estimate", "point.csv", "-e", KERNEL],
            &["did you mean points.csv?"],
        ),
        on(
            "a folder",
            &["estimate", ".", "-e", KERNEL],
            &[".: is a folder; give a file"],
        ),
        on(
            "targets missing",
            &["estimate", "points.csv", "--at", "t.csv", "-e", KERNEL],
            &["t.csv: No such file"],
        ),
        on(
            "output is a folder",
            &["estimate", "points.csv", "-e", KERNEL, "-o", "."],
            &["it is a folder; give a file"],
        ),
        on(
            "no folder for the output",
            &[
                "estimate",
                "points.csv",
                "-e",
                KERNEL,
                "-o",
                "no/such/out.csv",
            ],
            &["no/such/out.csv: cannot be written: no/such does not exist"],
        ),
        on(
            "a file as folder",
            &[
                "estimate",
                "points.csv",
                "-e",
                KERNEL,
                "-o",
                "points.csv/out.csv",
            ],
            &["points.csv/out.csv: cannot be written: points.csv is not a folder"],
        ),
    ]);
    #[cfg(target_os = "linux")]
    check(&[
        on(
            "disk full",
            &["estimate", "points.csv", "-e", KERNEL, "-o", "/dev/full"],
            &["/dev/full: cannot be written", "No space left"],
        ),
        on(
            "picture on a full disk",
            &["sample", "--density", "claw", "--n", "9", "-o", "/dev/full"],
            &["No space left"],
        ),
        on(
            "nobody may write here",
            &[
                "sample",
                "--density",
                "claw",
                "--n",
                "9",
                "-o",
                "/proc/out.csv",
            ],
            &["/proc/out.csv: cannot be written"],
        ),
        on(
            "nobody may write here either",
            &[
                "sample",
                "--density",
                "claw",
                "--n",
                "9",
                "-o",
                "/sys/out.csv",
            ],
            &["/sys/out.csv: cannot be written"],
        ),
    ]);
}

/// What must work although it looks odd.
#[test]
fn odd_inputs_that_are_right() {
    let estimate = |text: &str| {
        let bench = Bench::new().with("x.csv", text);
        bench
            .run(&[
                "estimate", "x.csv", "-c", "x", "-e", KERNEL, "--grid", "0:5:10",
            ])
            .succeeds()
            .says_nothing()
            .stdout
    };
    let plain = estimate("x,y\n1,0\n2,0\n4,0\n");
    for text in [
        "\u{feff}x,y\n1,0\n2,0\n4,0\n",
        "x,y\r\n1,0\r\n2,0\r\n4,0\r\n",
        "\u{feff}\"x\",\"y\"\r\n\"1\",\"a, \"\"b\"\"\"\r\n\"2\",\"\nc\"\r\n4,?",
        "x;y\n1;0\n2;0\n4;0\n",
        "\n\nx,y\n\n1,0\n2,0\n\n4,0\n\n",
        "y,x\nNA,1e0\n,+2\nnan,.4e1",
    ] {
        assert_eq!(estimate(text), plain, "{text:?}");
    }
    let bench = Bench::new()
        .with("one.csv", "7\n")
        .with("same.csv", "7\n7\n7\n");
    for name in ["one.csv", "same.csv"] {
        bench
            .run(&["estimate", name, "-e", KERNEL])
            .succeeds()
            .says_nothing();
        bench
            .run(&["estimate", name, "-e", "histogram = { width = 0.5 }"])
            .succeeds()
            .says_nothing();
    }
    // an outlier does not make the histogram allocate a bin for each place between
    let bench = Bench::new().with("x.csv", "0\n1e15\n");
    bench
        .run(&[
            "estimate",
            "x.csv",
            "-e",
            "histogram = { width = 1e-3 }",
            "--grid",
            "0:1:4",
        ])
        .succeeds();
}
