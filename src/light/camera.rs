//! A pinhole and the rays through its pixels.

use super::scene::Camera;
use super::vector::{Ray, Vector};

/// A camera with a picture of so many pixels.
#[derive(Clone, Copy, Debug)]
pub struct Film {
    camera: Camera,
    /// From the left edge of the picture to the right one at distance 1.
    across: Vector,
    /// From its upper edge to the lower one.
    down: Vector,
    width: usize,
    height: usize,
}

impl Film {
    /// The pixels are square; the camera's field of view spans the shorter side.
    pub fn new(camera: Camera, width: usize, height: usize) -> Self {
        let extent = 2.0 * (0.5 * camera.field_of_view.to_radians()).tan();
        let pixel = extent / width.min(height) as f64;
        Self {
            across: camera.direction.cross(&camera.up) * (pixel * width as f64),
            down: camera.up * (-pixel * height as f64),
            camera,
            width,
            height,
        }
    }

    /// Pixels in a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// The ray through a place of the picture in pixels from its upper left corner.
    pub fn ray(&self, x: f64, y: f64) -> Ray {
        let right = self.across * (x / self.width as f64 - 0.5);
        let lower = self.down * (y / self.height as f64 - 0.5);
        let direction = self.camera.direction + right + lower;
        Ray::new(self.camera.position, direction.normalize())
    }
}

#[cfg(test)]
mod tests {
    use super::{Camera, Film, Vector};

    /// The camera of the Cornell box looks along z with y up; x grows to the left.
    #[test]
    fn up_is_up_and_right_is_right() {
        let camera = Camera {
            position: Vector::new(278.0, 273.0, -800.0),
            direction: Vector::z(),
            up: Vector::y(),
            field_of_view: 39.3077,
        };
        let film = Film::new(camera, 200, 100);
        let middle = film.ray(100.0, 50.0);
        assert!((middle.direction - Vector::z()).norm() < 1e-12);
        let corner = film.ray(0.0, 0.0).direction;
        assert!(corner.x > 0.0 && corner.y > 0.0, "{corner}");
        // the upper edge is half a field of view away, the left one twice as far
        let tangent = (0.5 * 39.3077_f64.to_radians()).tan();
        assert!((corner.y / corner.z - tangent).abs() < 1e-12);
        assert!((corner.x / corner.z - 2.0 * tangent).abs() < 1e-12);
    }
}
