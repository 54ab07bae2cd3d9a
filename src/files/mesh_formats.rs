//! Formats of meshes that are not read, by what stands in their first bytes.

/// How such files begin.
const BEGINNINGS: [(&[u8], &str); 8] = [
    (b"ply\n", "a PLY"),
    (b"ply\r", "a PLY"),
    (b"OFF", "an OFF"),
    (b"glTF", "a glTF"),
    (b"Kaydara FBX", "an FBX"),
    (b"ISO-10303-21", "a STEP"),
    (b"BLENDER", "a Blender"),
    (b"PK\x03\x04", "a zipped (3MF?)"),
];

/// Bytes of a binary STL file before its facets, and of one facet.
const STL: (usize, usize) = (84, 50);

/// What a file is that is no OBJ file, with its article.
pub(crate) fn other(bytes: &[u8]) -> Option<&'static str> {
    if is_stl(bytes) {
        return Some("an STL");
    }
    BEGINNINGS.iter().find(|(beginning, _)| bytes.starts_with(beginning)).map(|(_, what)| *what)
}

/// Text: `solid NAME`, `facet normal ...`. Binary: 80 bytes of anything, the count of facets, and so many of them.
fn is_stl(bytes: &[u8]) -> bool {
    let head = String::from_utf8_lossy(&bytes[..bytes.len().min(1024)]);
    let mut words = head.split_whitespace();
    if words.next() == Some("solid") && words.any(|word| word == "facet" || word == "endsolid") {
        return true;
    }
    let count = bytes.get(80..STL.0).and_then(|count| count.try_into().ok()).map(u32::from_le_bytes);
    count.is_some_and(|n| (n as usize).checked_mul(STL.1).map(|facets| facets + STL.0) == Some(bytes.len()))
}
