use super::*;
use std::io::Write;

/// A file with these bytes, read as one wants it.
fn reading(bytes: &[u8], columns: Column<'_>, weight: Option<&str>) -> Result<Sample<1>, String> {
    let mut file = tempfile::NamedTempFile::new().expect("a temporary file");
    file.write_all(bytes).expect("written");
    let request = Request {
        columns: [columns],
        weight,
        domain: Domain::whole(),
    };
    let path = file.path().display().to_string();
    read(file.path(), &request).map_err(|e| e.to_string().replace(&path, "FILE"))
}

fn numbers(text: &str, column: &str) -> Result<Vec<f64>, String> {
    reading(text.as_bytes(), Column::Named(column), None).map(|s| s.coordinates().to_vec())
}

const ANY: Column<'static> = Column::Preferred(&[]);

/// A `.npy` with this header text and payload.
fn array(header: &str, payload: &[u8]) -> Vec<u8> {
    let mut bytes = array::MAGIC.to_vec();
    bytes.extend([1, 0]);
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(payload);
    bytes
}

fn doubles(numbers: &[f64]) -> Vec<u8> {
    numbers.iter().flat_map(|x| x.to_le_bytes()).collect()
}

#[test]
fn columns_are_found_by_name_or_number() {
    let text = "a,b\n1,2\n3,4\n";
    assert_eq!(numbers(text, "b"), Ok(vec![2.0, 4.0]));
    assert_eq!(numbers(text, "2"), Ok(vec![2.0, 4.0]));
    assert_eq!(numbers("1,2\n3,4\n", "2"), Ok(vec![2.0, 4.0]));
    // a name wins over a number
    assert_eq!(
        numbers("2,1\n5,6\nx,y\n", "1").map_err(|e| e.contains("\"x\"")),
        Err(true)
    );
    assert_eq!(numbers("2,one\n5,6\n", "2"), Ok(vec![5.0]));
}

#[test]
fn every_way_to_write_the_same_table_gives_the_same_numbers() {
    for text in [
        "a,b\n1,2.5\n3,-4e1\n",
        "\u{feff}a,b\n1,2.5\n3,-4e1\n",
        "a,b\r\n1,2.5\r\n3,-4e1\r\n",
        "\u{feff}\"a\",\"b\"\r\n\"1\",\"2.5\"\r\n3,-4e1",
        "a;b\n1;2.5\n3;-4e1\n",
        "a\tb\n1\t2.5\n3\t-4e1\n",
        " a , b \n 1 , 2.5 \n\n 3 , -4e1 \n\n",
        "\"a\",b\n\"1\",+2.5\n3,-40.0\n",
    ] {
        assert_eq!(numbers(text, "b"), Ok(vec![2.5, -40.0]), "{text:?}");
        assert_eq!(numbers(text, "a"), Ok(vec![1.0, 3.0]), "{text:?}");
    }
}

#[test]
fn a_table_in_fault_is_told_where_and_why() {
    for (text, column, expected) in [
        (
            "a,b\n1,2\n3\n",
            "a",
            "FILE:3:1: this row has 1 cells, but line 1 has 2",
        ),
        ("a,b\n1,2\n3,4,5\n", "a", "FILE:3:3: this row has 3 cells"),
        (
            "a,b\n1,2\n3,\n",
            "b",
            "FILE:3:2: a value is missing (the cell is empty)",
        ),
        (
            "a,b\n1,2\n\n\n3,NA\n",
            "b",
            "FILE:5:2: a value is missing (\"NA\")",
        ),
        (
            "a,b\n1,nan\n",
            "b",
            "FILE:2:2: a value is missing (\"nan\")",
        ),
        (
            "a,b\n1,-inf\n",
            "b",
            "FILE:2:2: \"-inf\" is not a finite number",
        ),
        (
            "a,b\n1,1e400\n",
            "b",
            "FILE:2:2: \"1e400\" is not a finite number",
        ),
        (
            "a,b\n1,four\n",
            "b",
            "FILE:2:2: \"four\" is not a number in column \"b\"",
        ),
        ("a;b\n1;2,5\n", "b", "the decimal mark is a point"),
        ("a,b\n1,\"2\n3,4\n", "b", "is a quote not closed?"),
        (
            "minutes,b\n1,2\n",
            "minute",
            "FILE:1: no column \"minute\"; did you mean \"minutes\"? the columns are \"minutes\", \"b\"",
        ),
        (
            "a,b\n1,2\n",
            "3",
            "no column \"3\"; the columns are \"a\", \"b\"",
        ),
        ("a,b\n1,2\n", "0", "no column \"0\""),
        ("a,a\n1,2\n", "a", "stands over columns 1 and 2"),
        ("a,b\n", "a", "FILE: there are no data"),
        ("", "a", "FILE: the file is empty"),
        ("\n\n", "a", "FILE: there are no data"),
        ("a\u{1b}[2J,b\n1,2\n", "x", "\\u{1b}[2J"),
    ] {
        let message = numbers(text, column).expect_err(text);
        assert!(message.contains(expected), "{text:?}: {message}");
    }
}

#[test]
fn bytes_that_are_no_table_are_called_what_they_are() {
    for (bytes, expected) in [
        (&b"\x1f\x8b\x08\x00"[..], "gzip"),
        (b"PK\x03\x04abc", ".npz"),
        (b"\xff\xfea\x00", "UTF-16"),
        (b"\x00\x01\x02", "binary"),
        (
            b"a\n1\n\xff\xfe\n",
            "FILE:3:1: \"\u{fffd}\u{fffd}\" is not UTF-8 text",
        ),
        (
            b"\x93NUMPY\x01",
            "the header of the array is damaged: the file ends in it",
        ),
        (b"\x93NUMPY\x09\x00\x01\x00 ", "version 9 is not known"),
        (b"\x93NUMPY\x02\x00\xff\xff\xff\xff", "longer than 64 KiB"),
    ] {
        let message = reading(bytes, ANY, None).expect_err("no table");
        assert!(message.contains(expected), "{expected}: {message}");
    }
}

#[test]
fn the_only_column_needs_no_name() {
    let only = |text: &str, weight| {
        reading(text.as_bytes(), ANY, weight).map(|s| s.coordinates().to_vec())
    };
    assert_eq!(only("a\n1\n2\n", None), Ok(vec![1.0, 2.0]));
    assert_eq!(only("w,a\n3,1\n", Some("w")), Ok(vec![1.0]));
    assert_eq!(only("a,w\n1,3\n", Some("w")), Ok(vec![1.0]));
    let message = only("a,b\n1,2\n", None).expect_err("two columns");
    assert!(message.contains("name the column to read; the columns are \"a\", \"b\""));
    let targets = reading(b"y,x\n1,2\n", Column::Preferred(&["t", "x"]), None);
    assert_eq!(targets.map(|s| s.coordinates().to_vec()), Ok(vec![2.0]));
}

#[test]
fn weights_become_shares() {
    let text = b"x,w\n1,3\n2,0\n5,1\n";
    let sample = reading(text, Column::Named("x"), Some("w")).expect("legal");
    let shares: Vec<f64> = (0..3).map(|i| sample.weight(i)).collect();
    assert_eq!(shares, [0.75, 0.0, 0.25]);
    for (text, expected) in [
        ("x,w\n1,-3\n", "FILE:2:2: the weight -3 is not allowed"),
        (
            "x,w\n1,0\n",
            "FILE: the weights sum to 0; the sum must be positive",
        ),
        ("x,w\n1,1e308\n2,1e308\n", "FILE: the weights sum to inf"),
    ] {
        let message = reading(text.as_bytes(), Column::Named("x"), Some("w")).expect_err(text);
        assert!(message.contains(expected), "{message}");
    }
    let twice = reading(text, Column::Named("x"), Some("x")).expect_err("both");
    assert!(twice.contains("both as data and as weight"), "{twice}");
}

#[test]
fn points_outside_the_domain_are_errors_at_their_place() {
    let mut file = tempfile::NamedTempFile::new().expect("a temporary file");
    file.write_all(b"x\n0.5\n1.5\n").expect("written");
    let request = Request {
        columns: [ANY],
        weight: None,
        domain: Domain::walled([0.0], [1.0]).expect("legal"),
    };
    let message = read(file.path(), &request)
        .expect_err("outside")
        .to_string();
    assert!(
        message.ends_with(":3:1: 1.5 lies outside the domain, 0 to 1"),
        "{message}"
    );
}

#[test]
fn arrays_of_every_supported_kind_give_the_same_numbers() {
    let (x, y) = ([1.5, -2.0, 1e300], [4.0, 5.0, 6.0]);
    let rows: Vec<f64> = x.iter().zip(y).flat_map(|(&x, y)| [x, y]).collect();
    let columns: Vec<f64> = x.into_iter().chain(y).collect();
    let plain = array(
        "{'descr': '<f8', 'fortran_order': False, 'shape': (3,), }\n",
        &doubles(&x),
    );
    let square = array(
        "{'descr': '<f8', 'fortran_order': False, 'shape': (3, 2), }\n",
        &doubles(&rows),
    );
    let fortran = array(
        "{'descr': '<f8', 'fortran_order': True, 'shape': (3, 2), }\n",
        &doubles(&columns),
    );
    let big: Vec<u8> = x.iter().flat_map(|x| x.to_be_bytes()).collect();
    let big = array(
        "{'descr': '>f8', 'fortran_order': False, 'shape': (3,), }\n",
        &big,
    );
    for (bytes, name) in [
        (&plain, "plain"),
        (&square, "rows"),
        (&fortran, "columns"),
        (&big, "big"),
    ] {
        let first = reading(bytes, Column::Named("1"), None).expect(name);
        assert_eq!(first.coordinates(), x, "{name}");
    }
    for bytes in [&square, &fortran] {
        let second = reading(bytes, Column::Named("2"), Some("1"));
        assert!(
            second
                .expect_err("negative weight")
                .contains("FILE:2:1: the weight -2")
        );
        let second = reading(bytes, Column::Named("2"), None).expect("legal");
        assert_eq!(second.coordinates(), y);
    }
    let half: Vec<u8> = [0.5_f32, 2.0]
        .iter()
        .flat_map(|x| x.to_le_bytes())
        .collect();
    let half = array(
        "{'descr': '<f4', 'fortran_order': False, 'shape': (2,), }\n",
        &half,
    );
    assert_eq!(
        reading(&half, ANY, None).expect("single").coordinates(),
        [0.5, 2.0]
    );
}

#[test]
fn what_the_crate_writes_is_read() {
    use npyz::WriterBuilder;
    let mut bytes = std::io::Cursor::new(Vec::new());
    let mut writer = npyz::WriteOptions::new()
        .default_dtype()
        .writer(&mut bytes)
        .begin_1d()
        .expect("begun");
    writer.extend([1.0_f64, 2.0, 3.0]).expect("written");
    writer.finish().expect("finished");
    let sample = reading(bytes.get_ref(), ANY, None).expect("legal");
    assert_eq!(sample.coordinates(), [1.0, 2.0, 3.0]);
}

#[test]
fn an_array_in_fault_is_told_where_and_why() {
    let deep = "(".repeat(60_000);
    let header = |shape: &str, kind: &str| {
        format!("{{'descr': {kind}, 'fortran_order': False, 'shape': {shape}, }}\n")
    };
    let cases: [(Vec<u8>, &str); 12] = [
        (
            array(&header("(3,)", "'<f8'"), &doubles(&[1.0])),
            "the file is cut short: its header promises 3 rows (24 bytes), it holds 8 bytes",
        ),
        (
            array(&header("(1000000000000,)", "'<f8'"), &doubles(&[1.0])),
            "promises 1000000000000 rows (7.3 TiB)",
        ),
        (
            array(&header("(99999999999999999999,)", "'<f8'"), &[]),
            "its shape is larger than any file",
        ),
        (
            array(&header("(9999999999,9999999999,9999999999)", "'<f8'"), &[]),
            "its shape is larger than any file",
        ),
        (
            array(&header("(-3,)", "'<f8'"), &[]),
            "dimension cannot be negative",
        ),
        (
            array(&header("(2, 2, 2)", "'<f8'"), &doubles(&[0.0; 8])),
            "the array has the shape [2, 2, 2]",
        ),
        (
            array(&header("(2,)", "'<i8'"), &[0; 16]),
            "the array holds '<i8'; read are '<f8' and '<f4'",
        ),
        (
            array(&header("(2,)", "[('a', '<f8')]"), &[0; 16]),
            "the array holds [('a', '<f8')",
        ),
        (
            array(&header("(0,)", "'<f8'"), &[]),
            "FILE: there are no data",
        ),
        (array(&deep, &[]), "nested too deeply"),
        (
            array("{'descr': ", &[]),
            "the header of the array is damaged",
        ),
        (
            array(&header("(2,)", "'<f8'"), &doubles(&[1.0, f64::NAN])),
            "FILE:2:1: NaN is not a finite number",
        ),
    ];
    for (bytes, expected) in cases {
        let message = reading(&bytes, ANY, None).expect_err(expected);
        assert!(message.contains(expected), "{expected}: {message}");
    }
}

#[test]
fn a_row_without_end_is_refused_early() {
    let endless = "1".repeat(table::LONGEST_ROW + (1 << 18));
    let message = numbers(&format!("x\n{endless}\n"), "x").expect_err("endless");
    assert!(message.contains("longer than 16 MiB"), "{message}");
}

#[test]
fn many_rows_keep_their_order_and_lines() {
    let mut text = b"x\n".to_vec();
    for i in 0..100_000 {
        writeln!(text, "{}", f64::from(i) * 0.5).expect("a string");
    }
    let read = reading(&text, ANY, None).expect("legal");
    let read = read.coordinates();
    assert!(
        read.iter()
            .enumerate()
            .all(|(i, &x)| (x - i as f64 * 0.5).abs() < 1e-12)
    );
    text.extend(b"oops\n");
    let message = reading(&text, ANY, None).expect_err("not a number");
    assert!(message.starts_with("FILE:100002:1: \"oops\""), "{message}");
}

#[test]
fn a_long_array_is_read_by_all_threads_as_by_one() {
    let n = (1 << 19) + 12_345;
    let mut values: Vec<f64> = (0..n).map(|i| f64::from(i).sqrt()).collect();
    let header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({n},), }}\n");
    let got = reading(&array(&header, &doubles(&values)), ANY, None).expect("legal");
    assert_eq!(got.coordinates(), values);
    // what is wrong is found as in a short one
    values[400_000] = f64::NAN;
    let error = reading(&array(&header, &doubles(&values)), ANY, None).expect_err("not finite");
    assert!(error.starts_with("FILE:400001"), "{error}");
    let cut = &array(&header, &doubles(&values[..500_000]));
    assert!(
        reading(cut, ANY, None)
            .expect_err("cut")
            .contains("cut short")
    );
}
