//! Files of data.

use super::{Bad, KERNEL, bad, check};
use crate::support::Bench;
use std::fs::File;

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
