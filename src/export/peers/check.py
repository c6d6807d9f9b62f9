"""Irradiance at the points of a reference by Mitsuba 3, beside what the reference says.

python check.py points.csv [paths a point]; points.csv is written by
`selflink reference SCENE --out points.csv`, or by `selflink probe SCENE --points ... --out points.csv` to check the solver.
"""
import os
import sys

import numpy as np
import mitsuba as mi

mi.set_variant("llvm_ad_rgb")
import drjit as dr  # noqa: E402  (needs the variant)

# Where the zero of scene.xml lies in the coordinates of the scene's file, and of points.csv.
ORIGIN = (0.0, 0.0, 0.0)
# Paths traced at once.
BATCH = 1 << 21

points = np.genfromtxt(sys.argv[1], delimiter=",", names=True)
paths = int(sys.argv[2]) if len(sys.argv) > 2 else 4096
scene = mi.load_file(os.path.join(os.path.dirname(os.path.abspath(__file__)), "scene.xml"))
integrator = scene.integrator()
position = np.stack([points[axis] for axis in ("x", "y", "z")]) - np.array([ORIGIN]).T
normal = np.stack([points[axis] for axis in ("nx", "ny", "nz")])
count = position.shape[1]
# The spread of the passes tells the error, so there are many.
a_pass = max(1, min(paths // 32, BATCH // count))
passes = -(-paths // a_pass)
total, squares = np.zeros((3, count)), np.zeros((3, count))
for number in range(passes):
    sampler = mi.load_dict({"type": "independent"})
    sampler.seed(number, count * a_pass)
    point = dr.arange(mi.UInt32, count * a_pass) // a_pass
    at = dr.gather(mi.Point3f, mi.Point3f(position), point)
    up = dr.gather(mi.Vector3f, mi.Vector3f(normal), point)
    away = mi.warp.square_to_cosine_hemisphere(sampler.next_2d())
    offset = 2e-5 * (1 + dr.max(dr.abs(at)))
    ray = mi.RayDifferential3f(at + offset * up, mi.Frame3f(up).to_world(away))
    radiance, _, _ = integrator.sample(scene, sampler, ray)
    # Rays meet small emitters, such as the sun's disc, by chance alone: the light that emitters send here is sampled on its own.
    met = scene.ray_intersect(ray)
    radiance -= met.emitter(scene).eval(met)
    here = dr.zeros(mi.SurfaceInteraction3f)
    here.p, here.n = at + offset * up, up
    towards, sent = scene.sample_emitter_direction(here, sampler.next_2d(), True)
    light = np.pi * radiance + sent * dr.maximum(dr.dot(up, towards.d), 0)
    mean = np.array(light).reshape(3, count, a_pass).mean(axis=2)
    total += mean
    squares += mean * mean
theirs = total / passes
their_error = np.sqrt(np.maximum(squares / passes - theirs**2, 0) / (passes - 1))
ours = np.stack([points["E_" + colour] for colour in "rgb"])
named = "error_" if "error_r" in points.dtype.names else "se_"  # of a reference, of a probe
our_error = np.stack([points[named + colour] for colour in "rgb"])
error = np.sqrt(their_error**2 + our_error**2)
known = error > 0
z = (ours - theirs)[known] / error[known]
# The colours of a path are bright or dark together.
of_ratio = np.sqrt((error.sum(axis=0) ** 2).sum()) / theirs.sum()
print(f"{count} points, {passes * a_pass} paths each: ratio of the means {ours.sum() / theirs.sum():.4f} ± {of_ratio:.4f}")
print(f"beyond three standard errors: {100 * np.mean(np.abs(z) > 3):.2f} %; mean square of z {np.mean(z * z):.2f}")
