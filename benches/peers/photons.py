"""The photon walk of `lab` beside Mitsuba 3 on the same box: paths and ray segments per CPU second on one thread.

    python3 benches/peers/photons.py [--rounds 3]

Needs `pip install mitsuba numpy` and, for the variant llvm_ad_rgb, a libLLVM that Mitsuba finds. Two peers:

* `ptracer`, Mitsuba's particle tracer, on a film of one pixel. Each of its vertices also asks whether the camera sees it, which is work that `lab` does not
  do. It does not report its segments; they are counted on a walk of its rule of survival (src/integrators/ptracer.cpp: the largest channel of the carried weight, at most
  0.95, asked after the next hit is found). The rays to the camera are not counted.
* a walk written here in Dr.Jit: lamp, closest hit, survival by the power that is kept, cosine; no record of hits. Its segments are counted.

Every measurement is a process of its own; CPU time of that process without start and compilation (a first run of the same size is not counted).
"""

import argparse
import json
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]


def box(mi):
    """The box of data/cornell_box_rgb/blocks.csv, which is mi.cornell_box() with a front that absorbs."""
    scene = mi.cornell_box()
    scene["front"] = {
        "type": "rectangle",
        "to_world": mi.ScalarTransform4f().translate([0, 0, 1]).rotate([0, 1, 0], 180),
        "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": [0, 0, 0]}},
    }
    return scene


def walk(mi, dr, scene, count, seed, as_ptracer=False):
    """`count` photons; the number of segments. Survival by the power that is kept, or as ptracer has it."""
    sampler = mi.load_dict({"type": "independent"})
    sampler.seed(seed, count)
    mask = mi.Bool(True)
    ray, weight, _ = scene.sample_emitter_ray(
        mi.Float(0), sampler.next_1d(), sampler.next_2d(), sampler.next_2d(), mask
    )
    active, segments = dr.full(mi.Bool, True, count), dr.zeros(mi.UInt32, count)
    weight = mi.Color3f(weight)
    context = mi.BSDFContext(mi.TransportMode.Importance)

    def fly(ray, weight, active, segments, sampler):
        segments = segments + dr.select(active, mi.UInt32(1), mi.UInt32(0))
        hit = scene.ray_intersect(ray, active)
        active = active & hit.is_valid()
        bsdf = hit.bsdf(ray)
        sample, value = bsdf.sample(context, hit, sampler.next_1d(active), sampler.next_2d(active), active)
        after = weight * value
        if as_ptracer:
            share = dr.minimum(dr.max(after), 0.95)
            # the next hit is found before the roulette: a photon that it ends has flown once more, unless it is black already
            flies = active & (dr.max(after) > 0)
            active = flies & (sampler.next_1d(active) < share)
            segments = segments + dr.select(flies & ~active, mi.UInt32(1), mi.UInt32(0))
        else:
            share = dr.sum(after) / dr.sum(weight)
            active = active & (sampler.next_1d(active) < share)
        weight = dr.select(active, after / share, weight)
        ray = hit.spawn_ray(hit.to_world(sample.wo))
        return ray, weight, active, segments, sampler

    state = dr.while_loop(
        state=(mi.Ray3f(ray), weight, active, segments, sampler),
        cond=lambda ray, weight, active, segments, sampler: active,
        body=fly,
    )
    return state[3]


def peer(variant, what, count):
    """In a process of its own: prints JSON."""
    import time

    import drjit as dr
    import mitsuba as mi

    mi.set_variant(variant)
    dr.set_thread_count(1)
    scene = box(mi)
    if what == "ptracer":
        scene["integrator"] = {"type": "ptracer", "max_depth": -1, "rr_depth": 1, "hide_emitters": False}
        scene["sensor"]["film"]["width"] = scene["sensor"]["film"]["height"] = 1
    scene = mi.load_dict(scene)

    def once(seed):
        if what == "ptracer":
            image = mi.render(scene, spp=count, seed=seed)
            dr.eval(image)
            dr.sync_thread()
            return None
        segments = walk(mi, dr, scene, count, seed, as_ptracer=what == "counted")
        return int(dr.sum(mi.UInt64(segments))[0])

    once(0)
    start = time.process_time()
    segments = once(1)
    seconds = time.process_time() - start
    print(json.dumps({"paths": count, "segments": segments, "seconds": seconds}))


def measured(command):
    done = subprocess.run(command, capture_output=True, text=True)
    # beside progress bars and words that Dr.Jit has at the end
    said = [line[line.index("{") :] for line in done.stdout.splitlines() if line.endswith("}") and "{" in line]
    if done.returncode != 0 or not said:
        return {"error": (done.stderr.strip().splitlines() or [f"no output, exit code {done.returncode}"])[-1]}
    return json.loads(said[-1])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--paths", type=int, default=1_000_000)
    parser.add_argument("--peer", nargs=2, metavar=("VARIANT", "WHAT"), help=argparse.SUPPRESS)
    parser.add_argument("--program", type=pathlib.Path, help="the built example peers-photon; built by default")
    given = parser.parse_args()
    if given.peer:
        peer(*given.peer, given.paths)
        return
    program = given.program
    if program is None:
        subprocess.run(["cargo", "build", "--release", "--example", "peers-photon"], cwd=ROOT, check=True)
        program = ROOT / "target/release/examples/peers-photon"
    scene = str(ROOT / "data/scenes/cornell-box-rgb.toml")
    work = {
        "lab": [str(program), scene, str(max(1, given.paths // 4096))],
        **{
            f"Mitsuba {variant} {what}": [sys.executable, __file__, "--paths", str(paths), "--peer", variant, what]
            for variant, what, paths in [
                ("scalar_rgb", "ptracer", given.paths // 4),
                ("llvm_ad_rgb", "ptracer", given.paths),
                ("llvm_ad_rgb", "walk", given.paths),
            ]
        },
    }
    counted = measured([sys.executable, __file__, "--paths", str(given.paths), "--peer", "llvm_ad_rgb", "counted"])
    lengths = None if "error" in counted else counted["segments"] / counted["paths"]
    found = {name: [] for name in work}
    for _ in range(given.rounds):
        for name, command in work.items():
            found[name].append(measured(command))
    for name, runs in found.items():
        good = sorted((run for run in runs if "error" not in run), key=lambda run: run["seconds"] / run["paths"])
        if not good:
            print(f"{name}: {runs[0]['error']}")
            continue
        middle = good[len(good) // 2]
        paths = middle["paths"] / middle["seconds"] / 1e6
        segments = middle["segments"] and middle["segments"] / middle["seconds"] / 1e6
        if segments is None and lengths is not None:
            segments = paths * lengths
        rays = f", {segments:.2f} M segments" if segments else ""
        print(f"{name}: {paths:.2f} M paths{rays} per CPU second")


if __name__ == "__main__":
    main()
