//! OBJ and MTL: what comes in, what is left out, and that both are said.

use std::f32::consts::PI;

use glam::Vec3;
use selflink::scene::{MaterialId, load_file};

use crate::support::Folder;
use crate::{SQUARE, close, load_obj, total_area};

#[test]
fn quads_stay_quads_and_larger_polygons_become_triangles() {
    // A quad, a concave L of area 3, a slightly warped pentagon and a strongly warped quad.
    let scene = load_obj(
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n\
         v 0 0 1\nv 2 0 1\nv 2 1 1\nv 1 1 1\nv 1 2 1\nv 0 2 1\nf 5 6 7 8 9 10\n\
         v 0 0 2\nv 2 0 2\nv 3 1 2.01\nv 1 2 2\nv 0 1 2\nf -5 -4 -3 -2 -1\n\
         v 0 0 3\nv 1 0 3\nv 1 1 3\nv 0 1 3.5\nf -4 -3 -2 -1\n",
        "",
    );
    assert_eq!(scene.polygons.iter().filter(|polygon| polygon.is_quad()).count(), 1);
    assert_eq!(scene.polygons.len(), 1 + 4 + 3 + 2);
    assert_eq!(scene.skipped.triangulated_polygons, 3);
    let of_the_l: f32 = scene.polygons[1..5].iter().map(|polygon| scene.area(polygon)).sum();
    assert!((of_the_l - 3.0).abs() < 1e-6, "shoelace area of the L: {of_the_l}");
    assert!(scene.polygons.iter().all(|polygon| scene.normal(polygon).z > 0.8), "windings are kept");
}

#[test]
fn names_are_paths_and_faces_of_one_name_belong_together() {
    let scene = load_obj(
        &format!(
            "{SQUARE}v 0 0 1\nv 0 0 2\nv 0 1 2\n\
             f 1 2 3\no office/desk_2/lamp\nf 1 3 4\ng office/desk\nusemtl a\nf 5 6 7\n  o office//desk_2/lamp\nusemtl b\nf 1 2 5\n\
             g office/desk_2\nf 2 3 6\n"
        ),
        "",
    );
    let paths: Vec<String> = scene.polygons.iter().map(|polygon| scene.group_path(polygon.group)).collect();
    assert_eq!(paths, ["", "office/desk_2/lamp", "office/desk", "office/desk_2/lamp", "office/desk_2"]);
    assert_eq!(scene.polygons[1].group, scene.polygons[3].group);
    assert_eq!(scene.groups.len(), 5, "root, office, desk_2, lamp and desk");
    for (index, group) in scene.groups.iter().enumerate() {
        assert_eq!(group.parent.is_none(), index == 0);
        assert!(group.parent.is_none_or(|parent| (parent.0 as usize) < index), "parents precede children");
    }
}

/// Truth: the conventions Kd = ρ and B_e = π·Ke.
#[test]
fn materials_follow_the_mtl_file() {
    let scene = load_obj(
        &format!(
            "mtllib a.mtl\r\n{}usemtl room:wall paint\r\nf 1 2 3\r\nusemtl lamp\r\nf 1 3 4 # the lamp\r\n\
             usemtl mirror\r\nf 1 2 4\r\nusemtl glass\r\nf 2 3 4\r\nusemtl pane\r\nf 4 3 2\r\n\tusemtl   ghost\r\nf 4 3 1\r\n",
            SQUARE.replace('\n', "\r\n")
        ),
        "\r\nnewmtl room:wall paint\r\n\tKd 0.1 0.2 0.3 # blue\r\nNs 10\r\nnewmtl lamp\r\nKd 0 0 0\r\nKe 17 12 4\r\nnewmtl mirror\r\nKd 1 1 -0.5\r\n\
         newmtl glass\r\nKd 1 1 1\r\nd 0.4\r\nnewmtl pane\r\nTr 0.9\r\nnewmtl unused\r\nKd 0 0\r\n",
    );
    let [wall, lamp, mirror] = ["room:wall paint", "lamp", "mirror"].map(|name| {
        let MaterialId(index) = scene.material_named(name).expect("a material of the file");
        &scene.materials[index as usize]
    });
    assert!(close(wall.reflectance, Vec3::new(0.1, 0.2, 0.3)) && wall.emission == Vec3::ZERO);
    assert!(close(lamp.emission, PI * Vec3::new(17.0, 12.0, 4.0)));
    assert_eq!(mirror.reflectance, Vec3::new(0.95, 0.95, 0.0));
    let ghost = &scene.materials[scene.polygons[3].material.0 as usize];
    assert_eq!((ghost.name.as_str(), ghost.reflectance), ("ghost", Vec3::splat(0.5)));
    assert_eq!(scene.skipped.clamped_materials, 1);
    assert_eq!(scene.skipped.transparent_faces, 2);
    assert_eq!(scene.skipped.faces_without_material, 1);
    let said = scene.skipped.sentences().join(" ");
    assert!(
        said.contains("`ghost`") && said.contains("Line 16 of the material file `a.mtl` is not understood"),
        "{said}"
    );
}

#[test]
fn a_missing_material_file_gives_grey_and_says_so() {
    let scene = load_obj(&format!("mtllib gone.mtl\nmtllib ../secret.mtl\n{SQUARE}usemtl red\nf 1 2 3 4\n"), "");
    assert_eq!(scene.materials[0].reflectance, Vec3::splat(0.5));
    assert_eq!(scene.materials[0].name, "red");
    assert_eq!(scene.skipped.faces_without_material, 1);
    let said = scene.skipped.sentences().join(" ");
    for part in ["gone.mtl", "../secret.mtl` lies outside", "`red`"] {
        assert!(said.contains(part), "{part}: {said}");
    }
}

/// Truth: sRGB 188 is linear 0.5029, times Kd 0.5.
#[test]
fn textures_count_as_their_mean_colour() {
    let folder = Folder::new();
    let path = folder.path("maps/grey wall.png");
    std::fs::create_dir_all(folder.path("maps")).expect("a writable folder");
    image::RgbImage::from_pixel(3, 2, image::Rgb([188; 3])).save(path).expect("a written image");
    folder.write(
        "room.mtl",
        "newmtl a\nKd 0.5 0.5 0.5\nmap_Kd -s 2 2 2 maps\\grey wall.png\nnewmtl b\nKd 0.5 0.5 0.5\nmap_Kd gone.png\n\
         newmtl c\nmap_Kd ../../out.png\n",
    );
    let obj = format!("mtllib room.mtl\n{SQUARE}usemtl a\nf 1 2 3\nusemtl b\nf 1 3 4\nusemtl c\nf 1 2 4\n");
    let scene = load_file(&folder.write("room.obj", obj)).expect("a sound scene");
    assert!((scene.materials[0].reflectance.x - 0.2514).abs() < 1e-3, "{}", scene.materials[0].reflectance);
    assert_eq!(scene.materials[1].reflectance, Vec3::splat(0.25), "a grey of one half stands for it");
    let notes = scene.skipped.sentences().join(" ");
    assert!(notes.contains("`gone.png` is not used") && notes.contains("`../../out.png` is not used"), "{notes}");
}

#[test]
fn faces_without_area_and_repeated_faces_are_left_out_but_not_backs() {
    let scene = load_obj(
        &format!(
            "{SQUARE}v 0.5 0 0\nv 0 0 0\nf 1 2 3 4\nf 3 4 1 2\nf 4 3 2 1\nf 6 2 3 4\nf 1 2 2\nf 1 5 2\nf 1 6 2\nf 1 2 3 3\nf 2 3 1\n\
             l 1 2 3\np 1\nf 1 2\n"
        ),
        "",
    );
    assert_eq!(scene.skipped.degenerate_faces, 3);
    assert_eq!(scene.skipped.duplicate_faces, 3, "rotated, by an equal vertex, and a triangle");
    let corner_counts: Vec<usize> = scene.polygons.iter().map(|polygon| polygon.corners().len()).collect();
    assert_eq!(corner_counts, [4, 4, 3], "a quad, its back, and the triangle that a doubled corner leaves");
    assert_eq!(scene.vertices.len(), 5, "equal positions are one vertex");
    assert_eq!(scene.skipped.lines_and_points, 3);
}

#[test]
fn lines_that_trip_parsers_are_read() {
    let scene = load_obj(
        "\u{feff}# Latin-1 and more\n  v 0 0 0 1.0\nv\t1 0 0 0.1 0.2 0.3\nv 1 1 \\\n 0\nvt 0 0\nvn 0 0 1\nf 1/1/1 2//1 \\\n3/99999999999/1 4\nv 0 1 0\n\
         s off\nweird words\n",
        "",
    );
    assert_eq!(scene.polygons.len(), 1);
    assert!((total_area(&scene) - 1.0).abs() < 1e-6, "weights and colours are not coordinates");
    let folder = Folder::new();
    let latin = [b"o caf\xe9\n", SQUARE.as_bytes(), b"f 1 2 3 4\n"].concat();
    assert!(load_file(&folder.write("latin.obj", latin)).is_ok());
}
