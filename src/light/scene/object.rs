//! Wavefront OBJ files: triangles by reference.

use super::super::vector::Vector;
use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

/// The largest file, in bytes.
const LARGEST: u64 = 1 << 30;

/// The triangles of all models in the file, polygons cut into triangles; corners as they are written.
///
/// Materials, normals and texture coordinates are not used.
///
/// # Errors
/// With what is wrong, in words, if the file cannot be read or is not such a file.
pub(super) fn triangles(path: &Path) -> Result<Vec<[Vector; 3]>, String> {
    let shown = path.display();
    let file = File::open(path).map_err(|error| format!("cannot read {shown}: {error}"))?;
    let about = file
        .metadata()
        .map_err(|error| format!("cannot read {shown}: {error}"))?;
    if about.len() > LARGEST {
        return Err(format!("{shown} is larger than {} MiB", LARGEST >> 20));
    }
    parse(&mut BufReader::new(file.take(LARGEST)))
        .map_err(|what| format!("{shown} is not a Wavefront OBJ file that can be used: {what}"))
}

fn parse(text: &mut impl BufRead) -> Result<Vec<[Vector; 3]>, String> {
    let options = tobj::LoadOptions {
        triangulate: true,
        ..tobj::LoadOptions::default()
    };
    // the materials of the file are none of ours
    let (models, _) = tobj::load_obj_buf(text, &options, |_| {
        Ok((Vec::new(), std::collections::HashMap::new()))
    })
    .map_err(|error| error.to_string())?;
    let mut triangles = Vec::new();
    for model in models {
        let mesh = model.mesh;
        let corner = |index: u32| {
            let at = 3 * index as usize;
            mesh.positions
                .get(at..at + 3)
                .map(|p| Vector::new(p[0], p[1], p[2]))
                .ok_or_else(|| format!("there is no vertex {}", index + 1))
        };
        for face in mesh.indices.chunks_exact(3) {
            triangles.push([corner(face[0])?, corner(face[1])?, corner(face[2])?]);
        }
    }
    Ok(triangles)
}

#[cfg(test)]
mod tests {
    use super::parse;

    #[test]
    fn quads_become_triangles_and_relative_indices_count_back() {
        let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\nf -4 -3 -2\n";
        let triangles = parse(&mut text.as_bytes()).expect("an object");
        assert_eq!(triangles.len(), 3);
        assert_eq!(triangles[0], triangles[2]);
    }

    #[test]
    fn nonsense_is_refused() {
        assert!(parse(&mut &b"v 0 0\nf 1 1 1\n"[..]).is_err());
        assert!(parse(&mut &b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"[..]).is_err());
    }
}
