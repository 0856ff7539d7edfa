//! `[material.NAME]`.

use super::kind;
use super::spectrum::Palette;
use crate::document::node::{Reader, Table};
use crate::document::problem::Problem;
use crate::light::material::{Dielectric, Lambertian, Material, Mirror, Phong};

const KINDS: [&str; 4] = ["lambertian", "mirror", "phong", "dielectric"];

/// A table whose single key names what the surface does.
pub(super) fn material(
    reader: &mut Reader,
    mut table: Table<'_>,
    palette: &mut Palette,
) -> Option<Material> {
    let found = kind(reader, &mut table, "a material", &KINDS);
    let unknown = table.finish(reader, &KINDS);
    let (name, mut inner, span) = found?;
    let mut number = |reader: &mut Reader, key: &str, help: &str, least: f64, most: f64| {
        let entry = inner.need(reader, key, help)?;
        let allowed = format!("a number from {least} to {most}");
        let x = reader
            .number(entry.item, &format!("`{key}`"), &allowed)?
            .real();
        if x >= least && x <= most {
            return Some(x);
        }
        reader.report(
            Problem::at(
                entry.item.span(),
                format!("`{key}` must be {allowed}, not {x}"),
            )
            .allowed(allowed),
        );
        None
    };
    if name == "dielectric" {
        let index = number(
            reader,
            "index",
            "the refractive index, 1.5 for glass",
            0.1,
            10.0,
        );
        if inner.finish(reader, &["index"]) || unknown {
            return None;
        }
        return Some(Material::Dielectric(Dielectric { index: index? }));
    }
    let exponent = (name == "phong")
        .then(|| number(reader, "exponent", "the sharpness of the lobe", 0.0, 1e6));
    let reflectance = inner
        .need(reader, "reflectance", "the share of light that goes on")
        .and_then(|entry| palette.spectrum(reader, entry.item, "`reflectance`", 1.0));
    let keys = ["reflectance", "exponent"];
    if inner.finish(reader, &keys[..if name == "phong" { 2 } else { 1 }]) || unknown {
        return None;
    }
    let reflectance = reflectance?;
    if let Some(Some(n)) = exponent
        && reflectance.largest() > (n + 1.0) / (n + 2.0)
    {
        reader.report(
            Problem::at(
                span,
                format!(
                    "a lobe of exponent {n} with a reflectance of {} would return more light than arrives",
                    reflectance.largest()
                ),
            )
            .allowed(format!("reflectances up to {}", (n + 1.0) / (n + 2.0))),
        );
        return None;
    }
    Some(match exponent {
        Some(exponent) => Material::Phong(Phong {
            reflectance,
            exponent: exponent?,
        }),
        None if name == "mirror" => Material::Mirror(Mirror { reflectance }),
        None => Material::Lambertian(Lambertian { reflectance }),
    })
}
