//! Lights and cameras that files bring.

use glam::Vec3;
use selflink::geometry::point_to_polygon;
use selflink::scene::outside::Daylight;
use selflink::scene::{Scene, Sidecar, load_file};

use crate::load;
use crate::support::{Folder, glb, square_bytes, square_json};

/// Truth: a directional light shines along −z of its node; of two the brightest is the sun, with
/// its lux (179 lm/W), and its colour.
#[test]
fn the_brightest_directional_light_is_the_sun() {
    let rest = r#""extensionsUsed": ["KHR_lights_punctual"],
        "extensions": {"KHR_lights_punctual": {"lights": [
            {"name": "Moon", "type": "directional", "intensity": 1},
            {"name": "Sun", "type": "directional", "intensity": 17900, "color": [1, 1, 0.5]}]}},
        "scenes": [{"nodes": [0, 1, 2]}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "nodes": [{"mesh": 0},
            {"rotation": [-0.70710678, 0, 0, 0.70710678], "extensions": {"KHR_lights_punctual": {"light": 0}}},
            {"rotation": [-0.38268343, 0, 0, 0.92387953], "extensions": {"KHR_lights_punctual": {"light": 1}}}]"#;
    let scene = load(&[("a.glb", &glb(&square_json(rest), &square_bytes()))], "a.glb");
    let sun = scene.outside().and_then(|outside| outside.sun().copied()).expect("a sun");
    let towards = Vec3::new(0.0, 1.0, 1.0).normalize();
    assert!(sun.direction.distance(towards) < 1e-5, "{}", sun.direction);
    assert!(sun.irradiance.distance(100.0 * Vec3::new(1.0, 1.0, 0.5)) < 0.1, "{}", sun.irradiance);
    let notes = scene.skipped.notes.join(" ");
    assert!(notes.contains("the brightest alone is the sun: Moon") && scene.skipped.ignored_lights == 1, "{notes}");
}

/// Truth: what a person lets in comes back by the sidecar; what cannot be used is reported, and a
/// picture that is gone costs the sky alone.
#[test]
fn daylight_comes_back_by_the_sidecar() {
    let folder = Folder::new();
    let path = folder.write("room.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nusemtl a\nf 1 2 3\n");
    let mut scene = load_file(&path).expect("a sound scene");
    let spec = Daylight {
        sky: Some("clear:9000lx".parse().expect("a sky")),
        sun: Some("az:200,el:40,60000lx".parse().expect("a sun")),
    };
    scene.add_daylight(&spec).expect("daylight");
    Sidecar::of(&scene).write(&Sidecar::path_for(&path)).expect("a writable folder");
    let again = load_file(&path).expect("a sound scene");
    assert!(again.has_light() && !again.has_lamp());
    assert_eq!((again.daylight(), &again.skipped), (spec, &scene.skipped));

    for (text, part) in [
        (r#"{"sky": "cloudy"}"#, "KIND:AMOUNT"),
        (r#"{"sky": "clear"}"#, "--sun"),
        (r#"{"sun": "az:1"}"#, "az:DEGREES"),
    ] {
        folder.write("room.selflink.json", text);
        let sentence = load_file(&path).expect_err("bad daylight").to_string();
        assert!(sentence.contains(part) && sentence.contains("room.selflink.json"), "{sentence}");
    }
    for picture in ["gone.hdr", "/etc/passwd.png"] {
        folder.write("room.selflink.json", format!(r#"{{"sky": "{picture}"}}"#));
        let scene = load_file(&path).expect("the rest is sound");
        assert!(
            scene.outside().is_none() && scene.skipped.notes.join(" ").contains(picture),
            "{:?}",
            scene.skipped.notes
        );
    }
}

/// Truth: E = I cos³θ/h² at a floor, by 179 lm/W; within 1 % at 1 to 10 m, straight below and
/// aslant, for a point and inside of a spot's inner cone; nothing outside of its outer cone.
#[test]
fn punctual_lights_keep_their_candelas_and_cones() {
    let light = |kind: &str| {
        let rest = format!(
            r#""extensionsUsed": ["KHR_lights_punctual"],
            "extensions": {{"KHR_lights_punctual": {{"lights": [{{"name": "Bulb", "intensity": 179, "color": [1, 0.5, 0.25], "range": 7, {kind}}}]}}}},
            "scenes": [{{"nodes": [0, 1]}}], "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}, "indices": 1}}]}}],
            "nodes": [{{"mesh": 0, "translation": [50, 0, 0]}},
                {{"rotation": [-0.70710678, 0, 0, 0.70710678], "extensions": {{"KHR_lights_punctual": {{"light": 0}}}}}}]"#
        );
        load(&[("a.glb", &glb(&square_json(&rest), &square_bytes()))], "a.glb")
    };
    let irradiance = |scene: &Scene, occluders: &selflink::geometry::Occluders, point: Vec3| -> Vec3 {
        let lamps = scene.polygons.iter().filter(|polygon| scene.emits(polygon));
        let of_lamp = |polygon: &selflink::scene::Polygon| {
            let (corners, count) = scene.corner_positions(polygon);
            let middle = corners[..count].iter().sum::<Vec3>() / count as f32;
            // The sphere does not hide its own front.
            let outside = middle + 1e-4 * scene.normal(polygon);
            let is_seen = scene.normal(polygon).dot(point - middle) > 0.0 && !occluders.occluded(outside, point);
            if is_seen {
                point_to_polygon(point, Vec3::Y, &corners[..count]) * scene.surface(polygon).emission
            } else {
                Vec3::ZERO
            }
        };
        lamps.map(of_lamp).sum()
    };
    let truth = |h: f32, angle: f32| angle.cos().powi(3) / (h * h);
    let point = light(r#""type": "point""#);
    let spot = light(r#""type": "spot", "spot": {"innerConeAngle": 0.5, "outerConeAngle": 0.7}"#);
    for (scene, widest) in [(&point, 1.2_f32), (&spot, 0.48)] {
        assert_eq!((scene.lights[0].name.as_str(), scene.lights[0].range), ("Bulb", Some(7.0)));
        assert_eq!(scene.materials[scene.lights[0].material.0 as usize].name, "Bulb");
        let occluders = selflink::geometry::Occluders::new(scene);
        for h in [1.0, 3.0, 10.0] {
            for (angle, turn) in [(0.0, 0.0), (0.2, 1.0), (0.5 * widest, 2.0), (widest, 4.0_f32)] {
                let aside = h * angle.tan();
                let at = Vec3::new(aside * turn.cos(), -h, aside * turn.sin());
                let found = irradiance(scene, &occluders, at);
                let expected = truth(h, angle) * Vec3::new(1.0, 0.5, 0.25);
                assert!(
                    found.distance(expected) < 0.01 * expected.length(),
                    "{h} m, {angle}: {found} is not {expected}"
                );
            }
        }
    }
    let occluders = selflink::geometry::Occluders::new(&spot);
    for angle in [0.72_f32, 0.9, 1.3] {
        assert_eq!(irradiance(&spot, &occluders, Vec3::new(2.0 * angle.tan(), -2.0, 0.0)), Vec3::ZERO, "{angle}");
    }
    let half = irradiance(&spot, &occluders, Vec3::new(2.0 * 0.6_f32.tan(), -2.0, 0.0)) / truth(2.0, 0.6);
    assert!((0.3..0.7).contains(&half.x), "between the cones: {half}");
}

/// Truth: a camera of the file opens the scene: 1.6 m high, hfov = 2·atan(1.5·tan ½).
#[test]
fn cameras_of_the_file_are_kept() {
    let scene = load(
        &[(
            "a.glb",
            &glb(
                &square_json(
                    r#""cameras": [{"name": "door", "type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.01, "aspectRatio": 1.5}},
                    {"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "zfar": 9, "znear": 0.1}}],
                    "nodes": [{"mesh": 0}, {"camera": 0, "translation": [0.3, 1.6, 3.7]}, {"camera": 1}], "scenes": [{"nodes": [0, 1, 2]}],
                    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}]"#,
                ),
                &square_bytes(),
            ),
        )],
        "a.glb",
    );
    assert_eq!((scene.cameras.len(), scene.cameras[0].name.as_str(), scene.skipped.ignored_cameras), (1, "door", 1));
    let twice = r#""cameras": [{"name": "a", "type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.01}}],
        "nodes": [{"mesh": 0}, {"name": "b", "camera": 0}, {"name": "c", "camera": 0}, {"name": "c", "camera": 0}],
        "scenes": [{"nodes": [0, 1, 2, 3]}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}]"#;
    let shared = load(&[("a.glb", &glb(&square_json(twice), &square_bytes()))], "a.glb");
    let names: Vec<&str> = shared.cameras.iter().map(|camera| camera.name.as_str()).collect();
    assert_eq!(names, ["a", "c", "c 2"], "each can be chosen by its name");
    let pose = scene.camera.expect("the file's own");
    assert_eq!(pose.eye, Vec3::new(0.3, 1.6, 3.7));
    assert!((pose.target - pose.eye).normalize().distance(-Vec3::Z) < 1e-6);
    assert!((pose.hfov_deg - (2.0 * (1.5 * 0.5_f32.tan()).atan()).to_degrees()).abs() < 1e-3);
}
