//! What chooses other numbers than a bandwidth, for lists: each is written as the value of a parameter of its estimators.

/// A rule that chooses a number from the data.
pub struct Other {
    /// The parameter whose value it is, and where.
    pub parameter: &'static str,
    /// Its name.
    pub name: &'static str,
    /// One sentence.
    pub summary: &'static str,
    /// Cost in n points.
    pub cost: &'static str,
    /// Author, year, equation.
    pub reference: &'static str,
}

const fn other(
    parameter: &'static str,
    name: &'static str,
    summary: &'static str,
    cost: &'static str,
    reference: &'static str,
) -> Other {
    Other {
        parameter,
        name,
        summary,
        cost,
        reference,
    }
}

/// All of them.
pub static OTHERS: &[Other] = &[
    other(
        "histogram width",
        "scott",
        "3.49 s n^(-1/3), best for a normal",
        "O(n)",
        "Scott 1979, eq. 3.1",
    ),
    other(
        "histogram width",
        "freedman-diaconis",
        "2 IQR n^(-1/3)",
        "O(n)",
        "Freedman & Diaconis 1981",
    ),
    other(
        "histogram width",
        "sturges",
        "the range over log2 n + 1 bins",
        "O(n)",
        "Sturges 1926",
    ),
    other(
        "histogram width",
        "knuth",
        "the largest posterior probability of the number of bins",
        "O(n) a number of bins",
        "Knuth 2006",
    ),
    other(
        "histogram width",
        "stone",
        "the least cross-validated risk of the number of bins",
        "O(n) a number of bins",
        "Stone 1984",
    ),
    other(
        "polygon and shifted-histogram width",
        "normal-reference",
        "best for a normal",
        "O(n)",
        "Scott 1985",
    ),
    other(
        "nearest-neighbour k",
        "likelihood-cross-validation",
        "the largest likelihood of each point given all others, on the line and in the plane",
        "about 40 estimates at the data",
        "Silverman 1986, sections 3.4.4 and 5.2",
    ),
    other(
        "nearest-neighbour k",
        "lscv",
        "the least unbiased estimate of ISE over the domain, on the line",
        "about 40 estimates at the data",
        "Silverman 1986, sections 3.4.3 and 5.2",
    ),
    other(
        "series terms",
        "cross-validation",
        "the least unbiased estimate of MISE over the number of terms, on the line and in the plane",
        "O(n terms), squared with a taper",
        "Kronmal & Tarter 1968; Hart 1985",
    ),
];
