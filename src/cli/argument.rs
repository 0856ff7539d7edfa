//! Numbers, intervals and grids as people type them.

use crate::space::{Domain, Grid, GridError, Side};

/// A finite number above 0.
pub fn positive(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(x) if x > 0.0 && x.is_finite() => Ok(x),
        _ => Err("allowed is a finite number above 0".to_owned()),
    }
}

/// The confidence of an interval.
pub fn confidence(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(x) if (0.5..=0.9999).contains(&x) => Ok(x),
        _ => Err("allowed is a number from 0.5 to 0.9999, such as 0.95".to_owned()),
    }
}

/// A whole number from 1: `1000`, `1_000` or `1e3`.
pub fn count(text: &str) -> Result<u64, String> {
    let plain = text.trim().replace('_', "");
    if let Ok(n) = plain.parse::<u64>()
        && n > 0
    {
        return Ok(n);
    }
    match plain.parse::<f64>() {
        // exact up to here
        Ok(x) if (1.0..=9e15).contains(&x) && x.fract() == 0.0 => Ok(x as u64),
        _ => Err("allowed is a whole number from 1, such as 1000 or 1e6".to_owned()),
    }
}

/// The number of threads; what a thread costs makes more than this many a slip.
pub fn threads(text: &str) -> Result<usize, String> {
    match text.trim().parse::<usize>() {
        Ok(n) if (1..=1024).contains(&n) => Ok(n),
        _ => Err("allowed is a whole number from 1 to 1024".to_owned()),
    }
}

/// `LO:HI`, walls where finite; an end left out or infinite is open.
pub fn domain(text: &str) -> Result<Domain<1>, String> {
    const ALLOWED: &str =
        "allowed is LO:HI with LO < HI, such as 0:1, or 0: and :1 where one side is open";
    let (low, high) = text.split_once(':').ok_or(ALLOWED)?;
    let end = |text: &str, open: f64| match text.trim() {
        "" => Some(open),
        other => other.parse::<f64>().ok(),
    };
    let low = end(low, f64::NEG_INFINITY).ok_or(ALLOWED)?;
    let high = end(high, f64::INFINITY).ok_or(ALLOWED)?;
    let side = |x: f64| {
        if x.is_finite() {
            Side::Wall
        } else {
            Side::Open
        }
    };
    Domain::new([low], [high], [[side(low), side(high)]]).map_err(|_| ALLOWED.to_owned())
}

/// `LO:HI:N`, N equal cells.
pub fn grid(text: &str) -> Result<Grid<1>, String> {
    const ALLOWED: &str = "allowed is LO:HI:N with LO < HI and N cells, such as -3:3:512";
    let parts: Vec<&str> = text.split(':').collect();
    let [low, high, cells] = parts[..] else {
        return Err(ALLOWED.to_owned());
    };
    let end = |text: &str| {
        let number: Option<f64> = text.trim().parse().ok();
        number.filter(|x| x.is_finite()).ok_or(ALLOWED)
    };
    let cells = usize::try_from(count(cells)?).unwrap_or(usize::MAX);
    Grid::new([end(low)?], [end(high)?], [cells]).map_err(|error| match error {
        GridError::TooManyCells { limit, .. } => {
            format!("{cells} cells are too many; allowed are at most {limit}")
        }
        GridError::Bounds { .. } | GridError::NoCells { .. } => ALLOWED.to_owned(),
        other @ GridError::Unresolvable { .. } => other.to_string(),
    })
}

/// `NxM`: two whole numbers from 1.
pub fn cells(text: &str) -> Result<[usize; 2], String> {
    const ALLOWED: &str = "allowed is NxM, two whole numbers from 1 to 65536, such as 32x32";
    let one = |text: &str| match text.trim().parse::<usize>() {
        Ok(n) if (1..=65_536).contains(&n) => Ok(n),
        _ => Err(ALLOWED.to_owned()),
    };
    let (first, second) = text.split_once(['x', 'X', '×']).ok_or(ALLOWED)?;
    Ok([one(first)?, one(second)?])
}

/// One for each axis.
#[derive(Clone, Debug)]
pub struct Each<T>(pub Vec<T>);

fn each<T>(text: &str, one: impl Fn(&str) -> Result<T, String>) -> Result<Each<T>, String> {
    let axes: Vec<T> = text.split(',').map(one).collect::<Result<_, _>>()?;
    if axes.len() > 2 {
        return Err(format!(
            "{} axes: data are on a line or in the plane",
            axes.len()
        ));
    }
    Ok(Each(axes))
}

/// `LO:HI` or `LO:HI,LO:HI`.
pub fn domains(text: &str) -> Result<Each<Domain<1>>, String> {
    each(text, domain)
}

/// `LO:HI:N` or `LO:HI:N,LO:HI:N`.
pub fn grids(text: &str) -> Result<Each<Grid<1>>, String> {
    each(text, grid)
}

/// `X` or `X,Y`.
pub fn place(text: &str) -> Result<Each<f64>, String> {
    each(text, |text| match text.trim().parse::<f64>() {
        Ok(x) if x.is_finite() => Ok(x),
        _ => Err("allowed is X, or X,Y in the plane, in finite numbers".to_owned()),
    })
}

#[cfg(test)]
mod tests {
    use super::{count, domain, grid, positive, threads};
    use crate::space::Side;

    #[test]
    fn counts_are_read_as_people_write_them() {
        for (text, n) in [
            ("1", 1),
            ("1000", 1000),
            ("1_000_000", 1_000_000),
            ("1e6", 1_000_000),
        ] {
            assert_eq!(count(text), Ok(n));
        }
        for text in ["0", "-1", "1.5", "nan", "inf", "1e400", "", "ten", "1e18"] {
            assert!(count(text).is_err(), "{text}");
        }
        assert_eq!(count("9223372036854775807"), Ok(i64::MAX as u64));
    }

    #[test]
    fn what_is_not_positive_is_refused() {
        assert_eq!(positive("0.5"), Ok(0.5));
        for text in ["0", "-1", "nan", "inf", "1e400", "-0", "", "x"] {
            assert!(positive(text).is_err(), "{text}");
        }
        assert!(threads("0").is_err() && threads("100000").is_err() && threads("2") == Ok(2));
    }

    #[test]
    fn intervals_have_walls_where_they_end() {
        let half = domain("0:").expect("legal");
        assert_eq!(half.sides(), [[Side::Wall, Side::Open]]);
        assert_eq!(domain("-1:2").map(|d| d.low().to_vec()), Ok(vec![-1.0]));
        for text in ["", "1", "1:0", "0:0", "a:b", "nan:1", "0:1:2"] {
            assert!(domain(text).is_err(), "{text}");
        }
    }

    #[test]
    fn grids_are_checked() {
        assert_eq!(grid("-3:3:6").expect("legal").cells(), [6]);
        for text in [
            "0:1", "0:1:0", "1:0:5", "0:inf:5", "0:nan:5", "0:1:2:3", "0:1:-5", "::",
        ] {
            assert!(grid(text).is_err(), "{text}");
        }
        let message = grid("0:1:1000000000000").expect_err("too many");
        assert!(message.contains("at most 268435456"), "{message}");
    }
}
