//! Which program computes: numbers of one build are not mixed with those of another, nor taken for them.

use std::fs::File;
use std::io::Read;
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

/// The revision and the beginning of the hash of the running program itself: equal only for the same sources, compiled alike. Where the linker has put its own hash of the
/// whole program into it, as linkers do on Linux, that one is hashed, not once more what it is of: tens of megabytes, as long as a small experiment takes.
pub fn build() -> &'static str {
    static BUILD: LazyLock<String> = LazyLock::new(|| {
        // read early and once: a long run may outlive the file it was started from
        let hash = std::env::current_exe().and_then(|path| {
            let mut file = File::open(path)?;
            let mut hasher = blake3::Hasher::new();
            let mut beginning = Vec::new();
            file.by_ref().take(BEGINNING).read_to_end(&mut beginning)?;
            if let Some(own) = hash_of_linker(&beginning) {
                hasher.update(own);
                hasher.update(&file.metadata()?.len().to_le_bytes());
            } else {
                hasher.update(&beginning);
                std::io::copy(&mut file, &mut hasher)?;
            }
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

/// Where the linker's hash is looked for: it lies before all code.
const BEGINNING: u64 = 1 << 14;

/// The hash that the linker took of the program, from the note that holds it.
fn hash_of_linker(beginning: &[u8]) -> Option<&[u8]> {
    // the sizes of name and hash in bytes, the kind of note, and the name
    const NOTE: &[u8] = b"\x04\0\0\0\x14\0\0\0\x03\0\0\0GNU\0";
    const LENGTH: usize = 20;
    let elf = beginning.starts_with(b"\x7fELF");
    let mut notes = beginning.windows(NOTE.len() + LENGTH);
    notes
        .find(|bytes| elf && bytes.starts_with(NOTE))
        .map(|bytes| &bytes[NOTE.len()..])
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
    use super::{REVISION, build, difference, hash_of_linker};

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

    #[test]
    fn the_hash_of_the_linker_is_found_where_there_is_one() {
        let note = b"\x04\0\0\0\x14\0\0\0\x03\0\0\0GNU\0";
        let hash: Vec<u8> = (7..27).collect();
        let program = [b"\x7fELF....".as_slice(), note, &hash, b"code"].concat();
        assert_eq!(hash_of_linker(&program), Some(&hash[..]));
        assert_eq!(hash_of_linker(&program[1..]), None);
        assert_eq!(hash_of_linker(&program[..30]), None);
        assert_eq!(hash_of_linker(b""), None);
    }
}
