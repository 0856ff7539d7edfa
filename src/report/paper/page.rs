//! x
use super::pictures::Picture;
use super::{Fine, Material};
pub(super) fn compose(_m: &Material<'_>, _f: &Fine, _p: Vec<Picture>) -> String {
    String::new()
}
