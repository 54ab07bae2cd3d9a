//! A scene of one lamp and one black plate.

pub const SCENE: &str = r#"
[[emitter]]
type = "isotropic"
position = [0.0, 0.0, 1.0]
flux_lm = 100
[material.black]
type = "absorber"
[[surface]]
name = "plate"
type = "rectangle"
material = "black"
corner = [-1.0, -1.0, 0.0]
edge_u = [2.0, 0.0, 0.0]
edge_v = [0.0, 2.0, 0.0]
[[receiver]]
surface = "plate"
cells = [4, 4]
"#;
