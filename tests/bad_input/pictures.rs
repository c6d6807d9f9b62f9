//! Textures made to be too large, or to be decoded again and again.

use std::io::Cursor;

use crate::strict::{scene, with_a_hole};
use crate::support::{Folder, glb, square_bytes, square_json};

/// A PNG of one grey pixel.
pub fn one_pixel() -> Vec<u8> {
    picture(1, 1)
}

fn picture(width: u32, height: u32) -> Vec<u8> {
    let mut encoded = Vec::new();
    let image = image::GrayImage::from_pixel(width, height, image::Luma([128]));
    image.write_to(&mut Cursor::new(&mut encoded), image::ImageFormat::Png).expect("it can be encoded");
    encoded
}

/// A PNG whose header tells another size; the checksum fits.
fn png_of_size(width: u32, height: u32, bits: u8) -> Vec<u8> {
    let mut png = one_pixel();
    png[16..20].copy_from_slice(&width.to_be_bytes());
    png[20..24].copy_from_slice(&height.to_be_bytes());
    png[24] = bits;
    let crc = crc32(&png[12..29]);
    png[29..33].copy_from_slice(&crc.to_be_bytes());
    png
}

/// The checksum of a PNG's chunks (ISO 3309).
fn crc32(bytes: &[u8]) -> u32 {
    let step = |crc: u32, _| if crc & 1 == 1 { (crc >> 1) ^ 0xedb8_8320 } else { crc >> 1 };
    !bytes.iter().fold(u32::MAX, |crc, &byte| (0..8).fold(crc ^ u32::from(byte), step))
}

#[test]
fn pictures_that_claim_to_be_huge() {
    let bmp = |width: i32, height: i32| {
        let mut bmp = b"BM\x3a\0\0\0\0\0\0\0\x36\0\0\0\x28\0\0\0".to_vec();
        bmp.extend(width.to_le_bytes());
        bmp.extend(height.to_le_bytes());
        bmp.extend(b"\x01\0\x18\0\0\0\0\0\x04\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\x80\x80\x80\0");
        bmp
    };
    let jpeg =
        b"\xff\xd8\xff\xc0\0\x11\x08\xff\xff\xff\xff\x03\x01\x22\0\x02\x11\x01\x03\x11\x01\xff\xda\0\x0c\x03".to_vec();
    let cases = [
        ("huge.png", png_of_size(60_000, 60_000, 8)),
        ("bits.png", png_of_size(60_000, 60_000, 1)),
        ("most.png", png_of_size(i32::MAX as u32, i32::MAX as u32, 16)),
        ("long.png", png_of_size(u32::MAX, 1, 8)),
        ("none.png", png_of_size(0, 0, 8)),
        ("huge.bmp", bmp(60_000, 60_000)),
        ("least.bmp", bmp(i32::MAX, i32::MIN)),
        ("huge.jpg", jpeg),
        ("cut.png", one_pixel()[..40].to_vec()),
        ("words.png", b"hello".to_vec()),
    ];
    let folder = Folder::new();
    for (name, content) in cases {
        folder.write(name, content);
        folder.write("a.mtl", format!("newmtl m\nKd 0.25 0.25 0.25\nmap_Kd {name}\n"));
        let room = scene(&folder.write("a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nusemtl m\nf 1 2 3\n"));
        let notes = room.skipped.sentences().join(" ");
        assert!(notes.contains(&format!("The texture `{name}` is not used")), "{name}: {notes}");
        assert_eq!(room.materials[0].reflectance, glam::Vec3::splat(0.125), "{name}: a grey of one half for it");
    }
}

/// 3,000 images that are one picture of a megapixel.
#[test]
fn one_picture_under_many_names() {
    let folder = Folder::new();
    folder.write("a.png", picture(1000, 1000));
    let many = |each: fn(usize) -> String| (0..3000).map(each).collect::<Vec<_>>().join(",");
    let materials =
        many(|number| format!(r#"{{"pbrMetallicRoughness": {{"baseColorTexture": {{"index": {number}}}}}}}"#));
    let textures = many(|number| format!(r#"{{"source": {number}}}"#));
    let images = many(|_| r#"{"uri": "a.png"}"#.to_owned());
    let json = square_json(&format!(
        r#""materials": [{materials}], "textures": [{textures}], "images": [{images}], "nodes": [{{"mesh": 0}}],
        "scenes": [{{"nodes": [0]}}], "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}, "indices": 1, "material": 2999}}]}}]"#
    ));
    let room = scene(&folder.write("a.glb", glb(&json, &square_bytes())));
    let mean = room.materials[2999].reflectance;
    assert!((mean - glam::Vec3::splat(0.2159)).abs().max_element() < 1e-3, "sRGB 128 is linear 0.2159, not {mean}");
}

#[test]
fn a_texture_of_a_terabyte() {
    let folder = Folder::new();
    with_a_hole(&folder.path("a.png"), &one_pixel(), 1 << 40);
    folder.write("a.mtl", "newmtl m\nmap_Kd a.png\n");
    let room = scene(&folder.write("a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nusemtl m\nf 1 2 3\n"));
    let notes = room.skipped.sentences();
    assert!(notes[0].contains("it is longer than 2048 MiB"), "{notes:?}");
}
