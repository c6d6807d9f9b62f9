//! What `selflink export` writes for other programs, read back as they read it.

use std::collections::BTreeMap;
use std::path::Path;

use glam::Vec3;
use selflink::geometry::orient;
use selflink::scene::builtin::BuiltinScene;
use selflink::scene::{Scene, Sides};

use super::support::{Folder, name, refused, succeed};

/// A material as a program reads it: reflectance, radiance, and the sum of its faces' area vectors
/// and areas.
#[derive(Clone, Copy, Debug, Default)]
struct Described {
    reflectance: Vec3,
    radiance: Vec3,
    vector: Vec3,
    area: f32,
}

impl Described {
    fn add(&mut self, corners: &[Vec3]) {
        for index in 1..corners.len() - 1 {
            let vector = 0.5 * (corners[index] - corners[0]).cross(corners[index + 1] - corners[0]);
            self.vector += vector;
            self.area += vector.length();
        }
    }
}

/// Truth: the scene, material by material.
fn truth(scene: &Scene) -> Vec<Described> {
    let mut described: Vec<Described> = scene.materials.iter().map(|_| Described::default()).collect();
    for polygon in &scene.polygons {
        let of = &mut described[polygon.material.0 as usize];
        let material = &scene.materials[polygon.material.0 as usize];
        (of.reflectance, of.radiance) = (material.reflectance, material.emission / std::f32::consts::PI);
        let (corners, count) = scene.corner_positions(polygon);
        of.add(&corners[..count]);
    }
    described.retain(|of| of.area > 0.0);
    described
}

fn assert_described(found: &[Described], scene: &Scene) {
    let truth = truth(scene);
    assert_eq!(found.len(), truth.len(), "materials");
    for (found, truth) in found.iter().zip(&truth) {
        assert!(found.reflectance.distance(truth.reflectance) < 1e-6, "{found:?} {truth:?}");
        assert!(found.radiance.distance(truth.radiance) <= 1e-6 * truth.radiance.length(), "{found:?} {truth:?}");
        // Sums of thousands of faces in f32.
        assert!((found.area - truth.area).abs() < 1e-4 * truth.area, "{found:?} {truth:?}");
        assert!(found.vector.distance(truth.vector) < 1e-4 * truth.area, "{found:?} {truth:?}");
    }
}

fn prepared(builtin: BuiltinScene, sides: Sides) -> Scene {
    orient::apply(builtin.build(), sides).0
}

/// An element of XML.
#[derive(Debug, Default)]
struct Element {
    tag: String,
    attributes: BTreeMap<String, String>,
    children: Vec<Element>,
}

/// Reads elements with attributes and nothing else, which is all that a scene file has; what is not
/// closed panics.
fn parse_xml(text: &str) -> Element {
    let mut open = vec![Element::default()];
    for part in text.split('<').skip(1) {
        let (tag, between) = part.split_once('>').expect("a tag ends");
        assert!(between.trim().is_empty(), "text between tags: {between}");
        if let Some(name) = tag.strip_prefix('/') {
            let closed = open.pop().expect("an open element");
            assert_eq!(closed.tag, name);
            open.last_mut().expect("its parent").children.push(closed);
            continue;
        }
        let (tag, is_whole) = tag.strip_suffix('/').map_or((tag, false), |tag| (tag, true));
        let (name, mut rest) = tag.split_once(' ').unwrap_or((tag, ""));
        let mut element = Element { tag: name.to_owned(), ..Element::default() };
        while let Some((key, value)) = rest.split_once("=\"") {
            let (value, after) = value.split_once('"').expect("a value ends");
            element.attributes.insert(key.trim().to_owned(), value.to_owned());
            rest = after;
        }
        if is_whole { open.last_mut().expect("its parent").children.push(element) } else { open.push(element) }
    }
    assert_eq!(open.len(), 1, "not closed: {open:?}");
    open.pop().and_then(|mut root| root.children.pop()).expect("one element")
}

impl Element {
    fn child(&self, tag: &str) -> Option<&Element> {
        self.children.iter().find(|child| child.tag == tag)
    }

    fn named(&self, wanted: &str) -> &str {
        let child = self.children.iter().find(|child| child.attributes.get("name").is_some_and(|name| name == wanted));
        &child.unwrap_or_else(|| panic!("{wanted} is missing in {self:?}")).attributes["value"]
    }
}

fn three(text: &str) -> Vec3 {
    let numbers: Vec<f32> = text
        .split([' ', ','])
        .filter(|field| !field.is_empty())
        .map(|field| field.parse().expect("a number"))
        .collect();
    Vec3::from_slice(&numbers)
}

/// The triangles of a binary PLY file of float positions and lists of int.
fn read_ply(path: &Path) -> Vec<[Vec3; 3]> {
    let bytes = std::fs::read(path).expect("the mesh that the scene names");
    let marker = b"end_header\n";
    let end = bytes.windows(marker.len()).position(|window| window == marker).expect("a header") + marker.len();
    let header = std::str::from_utf8(&bytes[..end]).expect("an ASCII header");
    assert!(header.starts_with("ply\nformat binary_little_endian 1.0\n"), "{header}");
    let count = |what: &str| {
        let line = header.lines().find_map(|line| line.strip_prefix(&format!("element {what} "))).expect("a count");
        line.parse::<usize>().expect("a number")
    };
    let (vertices, faces) = bytes[end..].split_at(12 * count("vertex"));
    assert_eq!(faces.len(), 13 * count("face"));
    let vertex = |bytes: &[u8]| {
        let numbers: Vec<f32> = bytes.as_chunks::<4>().0.iter().map(|number| f32::from_le_bytes(*number)).collect();
        Vec3::from_slice(&numbers)
    };
    let vertices: Vec<Vec3> = vertices.as_chunks::<12>().0.iter().map(|bytes| vertex(bytes)).collect();
    let face = |bytes: &[u8; 13]| {
        assert_eq!(bytes[0], 3);
        let corners = bytes[1..].as_chunks::<4>().0;
        [0, 1, 2].map(|corner| vertices[i32::from_le_bytes(corners[corner]) as usize])
    };
    faces.as_chunks::<13>().0.iter().map(face).collect()
}

#[test]
fn mitsuba_reads_the_scene_that_it_is() {
    for builtin in [BuiltinScene::Cornell, BuiltinScene::Office] {
        let folder = Folder::new();
        let target = folder.path("made/when/needed");
        let (said, _) = succeed(&["export", builtin.name(), "--to", "mitsuba", name(&target)]);
        assert!(said.contains("scene.xml"), "{said}");
        let scene = prepared(builtin, Sides::Front);
        let root = parse_xml(&std::fs::read_to_string(target.join("scene.xml")).expect("it was written"));
        let described = root.children.iter().filter(|child| child.tag == "shape").map(|shape| {
            let bsdf = shape.child("bsdf").expect("a material");
            assert_eq!((shape.attributes["type"].as_str(), bsdf.attributes["type"].as_str()), ("ply", "diffuse"));
            let radiance = shape.child("emitter").map_or(Vec3::ZERO, |emitter| three(emitter.named("radiance")));
            let mut described =
                Described { reflectance: three(bsdf.named("reflectance")), radiance, ..Described::default() };
            let triangles = read_ply(&target.join(shape.named("filename")));
            triangles.iter().for_each(|triangle| described.add(triangle));
            described
        });
        assert_described(&described.collect::<Vec<_>>(), &scene);
        let sensor = root.child("sensor").expect("a camera");
        let camera = scene.camera.expect("our scenes have cameras");
        let look =
            &sensor.child("transform").and_then(|transform| transform.child("lookat")).expect("a view").attributes;
        assert_eq!((three(&look["origin"]), three(&look["target"])), (camera.eye, camera.target));
        assert_eq!((three(&look["up"]), sensor.named("fov_axis")), (camera.up, "x"));
        assert_eq!(sensor.named("fov").parse::<f32>(), Ok(camera.hfov_deg));
    }
}

/// A primitive of Radiance: modifier, type, name, strings and numbers.
struct Primitive<'a> {
    modifier: &'a str,
    kind: &'a str,
    name: &'a str,
    strings: Vec<&'a str>,
    numbers: Vec<f32>,
}

fn parse_rad(text: &str) -> Vec<Primitive<'_>> {
    let mut words = text.lines().filter(|line| !line.starts_with('#')).flat_map(str::split_whitespace);
    let mut primitives = Vec::new();
    while let Some(modifier) = words.next() {
        let mut word = || words.next().expect("a whole primitive");
        let (kind, name) = (word(), word());
        let count: usize = word().parse().expect("a number of strings");
        let strings = (0..count).map(|_| word()).collect();
        assert_eq!(word(), "0", "no whole numbers");
        let count: usize = word().parse().expect("a number of numbers");
        let numbers = (0..count).map(|_| word().parse().expect("a number")).collect();
        primitives.push(Primitive { modifier, kind, name, strings, numbers });
    }
    primitives
}

#[test]
fn radiance_reads_the_scene_that_it_is() {
    for builtin in [BuiltinScene::Cornell, BuiltinScene::Office] {
        let folder = Folder::new();
        let target = folder.path("rad");
        succeed(&["export", builtin.name(), "--to", "radiance", name(&target)]);
        let scene = prepared(builtin, Sides::Front);
        let text = std::fs::read_to_string(target.join("scene.rad")).expect("it was written");
        let primitives = parse_rad(&text);
        let known =
            |name: &str| primitives.iter().find(|primitive| primitive.name == name && primitive.kind != "polygon");
        // What a material reflects in front, which must be black behind.
        let reflectance = |name: &str| {
            let mixed = known(name).expect("defined");
            assert_eq!((mixed.kind, &mixed.strings[1..]), ("mixfunc", &["black", "if(Rdot,1,0)", "."][..]));
            let front = known(mixed.strings[0]).expect("defined");
            assert_eq!((front.kind, &front.numbers[3..]), ("plastic", &[0.0, 0.0][..]), "nothing shines");
            Vec3::from_slice(&front.numbers[..3])
        };
        assert_eq!(known("black").map(|black| black.numbers.as_slice()), Some(&[0.0; 5][..]));
        let mut described: BTreeMap<usize, Described> = BTreeMap::new();
        for polygon in primitives.iter().filter(|primitive| primitive.kind == "polygon") {
            let number = polygon.name.split('-').next().and_then(|number| number.parse().ok()).expect("a number");
            let material = known(polygon.modifier).expect("defined");
            let (reflectance, radiance) = match material.kind {
                "mixfunc" => (reflectance(material.name), Vec3::ZERO),
                "illum" => (reflectance(material.strings[0]), Vec3::from_slice(&material.numbers)),
                "light" => (Vec3::ZERO, Vec3::from_slice(&material.numbers)),
                other => panic!("{other}"),
            };
            let of = described.entry(number).or_default();
            (of.reflectance, of.radiance) = (reflectance, radiance);
            of.add(&polygon.numbers.as_chunks::<3>().0.iter().map(|corner| Vec3::from(*corner)).collect::<Vec<_>>());
        }
        assert_described(&described.into_values().collect::<Vec<_>>(), &scene);
        let view = std::fs::read_to_string(target.join("view.vf")).expect("it was written");
        let camera = scene.camera.expect("our scenes have cameras");
        let after = |option: &str| view.split_once(option).expect("an option of the view").1.split(" -v").next();
        assert_eq!(after("-vp ").map(three), Some(camera.eye), "{view}");
        assert_eq!(after("-vh ").and_then(|angle| angle.trim().parse().ok()), Some(camera.hfov_deg), "{view}");
    }
}

/// Truth: both sides of each face are written, and no second side lies at the place of the first,
/// where programs meet either.
#[test]
fn second_sides_lie_behind_the_first() {
    let folder = Folder::new();
    let (front, both) = (folder.path("front"), folder.path("both"));
    succeed(&["export", "cornell", "--to", "radiance", name(&front)]);
    succeed(&["export", "cornell", "--to", "radiance", name(&both), "--sides", "both"]);
    let planes = |folder: &Path| {
        let text = std::fs::read_to_string(folder.join("scene.rad")).expect("it was written");
        let polygons = parse_rad(&text).into_iter().filter(|primitive| primitive.kind == "polygon");
        polygons.map(|polygon| polygon.numbers).collect::<Vec<_>>()
    };
    let (front, both) = (planes(&front), planes(&both));
    assert_eq!(both.len(), 2 * front.len());
    let sum = |faces: &[Vec<f32>]| {
        let mut described = Described::default();
        for numbers in faces {
            described.add(&numbers.as_chunks::<3>().0.iter().map(|corner| Vec3::from(*corner)).collect::<Vec<_>>());
        }
        described
    };
    assert!(sum(&both).vector.length() < 1e-3, "as much looks the one way as the other");
    let corners = |numbers: &Vec<f32>| {
        let mut corners: Vec<[u32; 3]> =
            numbers.as_chunks::<3>().0.iter().map(|corner| corner.map(|number| (number + 0.0).to_bits())).collect();
        corners.sort_unstable();
        corners
    };
    let places: std::collections::BTreeSet<_> = both.iter().map(corners).collect();
    assert_eq!(places.len(), both.len(), "two faces at the same place");
}

/// Truth: the file's own coordinates, which hold more digits than single precision. Radiance
/// computes in double precision; Mitsuba is given the scene about its middle, and the script that
/// reads points of the file where that lies.
#[test]
fn a_scene_far_from_the_origin_keeps_its_shape() {
    let folder = Folder::new();
    let corners = ["500000.125 3 0.0625", "500001.25 3 0.0625", "500001.25 3 2.5", "500000.125 3 2.5"];
    let text = format!("v {}\nf 1 2 3 4\n", corners.join("\nv "));
    let (file, target) = (folder.write("far.obj", text), folder.path("out"));
    succeed(&["export", name(&file), "--to", "radiance", name(&target), "--ceiling-light"]);
    let rad = std::fs::read_to_string(target.join("scene.rad")).expect("it was written");
    assert!(corners.iter().all(|corner| rad.contains(corner)), "{rad}");
    succeed(&["export", name(&file), "--to", "mitsuba", name(&target)]);
    let check = std::fs::read_to_string(target.join("check.py")).expect("it was written");
    let origin = check.lines().find_map(|line| line.strip_prefix("ORIGIN = (")?.strip_suffix(')')).expect("a line");
    let origin: Vec<f64> = origin.split(", ").map(|number| number.parse().expect("a number")).collect();
    let mesh = std::fs::read_dir(target.join("meshes")).expect("a folder").next().expect("a mesh").expect("a file");
    let triangles = read_ply(&mesh.path());
    let places: Vec<f64> = triangles.iter().flatten().map(|corner| origin[0] + f64::from(corner.x)).collect();
    assert!(places.iter().all(|x| *x == 500_000.125 || *x == 500_001.25), "{places:?}");
}

#[test]
fn what_cannot_be_exported_is_said() {
    let folder = Folder::new();
    let file = folder.write("file", "");
    let said = refused(&["export", "cornell", "--to", "blender", name(&folder.path("x"))]);
    assert!(said.contains("mitsuba") && said.contains("radiance"), "{said}");
    let said = refused(&["export", "cornell", "--to", "mitsuba", name(&file)]);
    assert!(said.contains("another folder") || said.contains("choose a folder"), "{said}");
    assert!(refused(&["export", "cornell", "--to", "mitsuba"]).contains("DIR"));
}
