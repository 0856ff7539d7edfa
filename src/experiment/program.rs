//! Which program computes: numbers of one build are not mixed with those of another, nor taken for them.

use std::fs::File;
use std::sync::LazyLock;
use std::time::{SystemTime, UNIX_EPOCH};

/// The version of the laboratory.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// The revision of the sources that the laboratory was built from, `unknown` outside a repository. For people: sources that were modified after the
/// revision, unpacked from an archive, or unpacked inside another repository are not told apart by it. [`build`] does.
pub const REVISION: &str = git_version::git_version!(
    args = ["--always", "--dirty=-modified"],
    fallback = "unknown"
);

/// The revision and the beginning of the hash of the running program itself: equal only for the same sources, compiled alike.
pub fn build() -> &'static str {
    static BUILD: LazyLock<String> = LazyLock::new(|| {
        // read early and once: a long run may outlive the file it was started from
        let hash = std::env::current_exe().and_then(|path| {
            let mut hasher = blake3::Hasher::new();
            std::io::copy(&mut File::open(path)?, &mut hasher)?;
            Ok(hasher.finalize().to_hex()[..16].to_owned())
        });
        let own = hash.unwrap_or_else(|_| {
            // a program that cannot be read equals none, itself in another process included
            let now = SystemTime::now().duration_since(UNIX_EPOCH);
            let now = now.map_or(0, |since| since.as_nanos());
            format!("unreadable-{}-{now}", std::process::id())
        });
        format!("{REVISION} {own}")
    });
    &BUILD
}

/// How the builds `theirs` and this one differ, in words.
pub fn difference(theirs: &str) -> String {
    match theirs.split_whitespace().next() {
        Some(revision) if revision == REVISION => {
            format!("by another build of the same revision, {REVISION}")
        }
        Some(revision) => format!("by revision {revision}, and this is {REVISION}"),
        None => format!("by another build, and this is {REVISION}"),
    }
}

#[cfg(test)]
mod tests {
    use super::{REVISION, build, difference};

    #[test]
    fn a_build_is_told_by_what_it_is_made_of() {
        assert_eq!(build(), build());
        let (revision, hash) = build().split_once(' ').expect("two words");
        assert_eq!(revision, REVISION);
        assert_eq!(hash.len(), 16, "{hash}");
        assert!(difference(&format!("{REVISION} 0123456789abcdef")).contains("same revision"));
        assert!(difference("0123abc 0123456789abcdef").contains("revision 0123abc"));
        assert!(difference("").contains("another build"));
    }
}
