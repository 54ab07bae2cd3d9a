//! Writes the meshes of `scenes/room.toml`: `cargo run --release --example make_room -- scenes/room`.
//!
//! This file is their documentation. The room is the box 0 <= x <= 5, 0 <= y <= 4, 0 <= z <= 3 (metres), its inner faces
//! cut into squares of 1 m, two triangles each: 2 (5 x 4 + 4 x 3 + 3 x 5) squares, 188 triangles, whose fronts look into the
//! room. Neighbouring faces share the vertices of their common edge, so no light gets out between them. In the room:
//!
//! | mesh | what | triangles |
//! |---|---|---|
//! | table | a top of 1.6 x 0.8 x 0.04 m, 0.72 m high, and four legs: boxes, fronts outside | 60 |
//! | pillar | a box of 0.4 x 0.4 x 2.96 m, its sides cut in three along z | 28 |
//!
//! 276 triangles in all. Nothing touches: legs and pillar stand 20 mm off the floor, the top lies 20 mm above the legs,
//! the pillar ends 20 mm below the ceiling. So every mesh is closed, or a face of the room, and no two faces coincide.

use std::error::Error;
use std::fmt::Write;
use std::path::Path;

type Point = [f64; 3];

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("usage: make_room FOLDER")?;
    for (name, text) in files() {
        std::fs::write(Path::new(&folder).join(name), text)?;
    }
    Ok(())
}

/// Name and text of every file.
pub fn files() -> Vec<(&'static str, String)> {
    let [x, y, z] = [[5.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 3.0]];
    let origin = [0.0; 3];
    // Each front is the side of u x v: into the room.
    let face = |corner, (u, nu), (v, nv)| {
        let mut mesh = Mesh::default();
        mesh.grid(corner, (u, nu), (v, nv));
        mesh
    };
    let mut white = face(origin, (z, 3), (x, 5));
    white.grid(y, (x, 5), (z, 3));
    let mut pillar = Mesh::default();
    pillar.block([3.9, 2.7, 0.02], [4.3, 3.1, 2.98], [1, 1, 3]);
    vec![
        ("floor.obj", face(origin, (x, 5), (y, 4)).text("the floor, z = 0")),
        ("ceiling.obj", face(z, (y, 4), (x, 5)).text("the ceiling, z = 3")),
        ("red_wall.obj", face(origin, (y, 4), (z, 3)).text("the wall x = 0")),
        ("green_wall.obj", face(x, (z, 3), (y, 4)).text("the wall x = 5")),
        ("white_walls.obj", white.text("the walls y = 0 and y = 4")),
        ("table.obj", table().text("a table: its top, then its legs")),
        ("pillar.obj", pillar.text("a pillar")),
    ]
}

fn table() -> Mesh {
    let mut mesh = Mesh::default();
    mesh.block([1.0, 1.2, 0.68], [2.6, 2.0, 0.72], [1; 3]);
    for [x, y] in [[1.04, 1.24], [2.48, 1.24], [2.48, 1.88], [1.04, 1.88]] {
        mesh.block([x, y, 0.02], [x + 0.08, y + 0.08, 0.66], [1; 3]);
    }
    mesh
}

/// Vertices, each once, and triangles that run counter-clockwise seen from the front.
#[derive(Default)]
struct Mesh {
    vertices: Vec<Point>,
    triangles: Vec<[usize; 3]>,
}

impl Mesh {
    fn vertex(&mut self, p: Point) -> usize {
        if let Some(known) = self.vertices.iter().position(|v| *v == p) {
            return known;
        }
        self.vertices.push(p);
        self.vertices.len() - 1
    }

    /// The parallelogram corner + u + v in nu x nv parts, two triangles each; front: the side of u x v.
    fn grid(&mut self, corner: Point, (u, nu): (Point, usize), (v, nv): (Point, usize)) {
        // One product and one sum a component, so that faces that meet compute the same vertices.
        let at = |i: usize, j: usize| -> Point {
            std::array::from_fn(|k| corner[k] + u[k] * i as f64 / nu as f64 + v[k] * j as f64 / nv as f64)
        };
        for j in 0..nv {
            for i in 0..nu {
                let [a, b, c, d] =
                    [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)].map(|p| self.vertex(p));
                self.triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }

    /// The box from `min` to `max`, its faces cut in this many parts along x, y and z; front: outside.
    fn block(&mut self, min: Point, max: Point, [nx, ny, nz]: [usize; 3]) {
        let along =
            |axis: usize| -> Point { std::array::from_fn(|k| if k == axis { max[k] - min[k] } else { 0.0 }) };
        let (x, y, z) = ((along(0), nx), (along(1), ny), (along(2), nz));
        let beyond =
            |axis: usize| -> Point { std::array::from_fn(|k| if k == axis { max[k] } else { min[k] }) };
        self.grid(min, y, x);
        self.grid(beyond(2), x, y);
        self.grid(min, x, z);
        self.grid(beyond(1), z, x);
        self.grid(min, z, y);
        self.grid(beyond(0), y, z);
        self.vertices.iter_mut().flatten().for_each(|c| *c = (*c * 1e6).round() / 1e6);
    }

    /// As OBJ, in metres.
    fn text(&self, what: &str) -> String {
        let mut out = format!("# {what}; written by examples/make_room.rs\n");
        for [x, y, z] in &self.vertices {
            let _infallible = writeln!(out, "v {x} {y} {z}");
        }
        for [a, b, c] in &self.triangles {
            let _infallible = writeln!(out, "f {} {} {}", a + 1, b + 1, c + 1);
        }
        out
    }
}
