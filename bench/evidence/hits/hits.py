#!/usr/bin/env python3
"""The eight tests of Chung and Ooi (Granular Matter 13, 643, 2011) at their parameters, and the ninth that Kratos adds, two equal
spheres at several restitutions, by Hertz's and Mindlin's law beside closed forms.

  hits.py      as CSV: at each setting what scree gives, the closed form, and by how much it differs; of oblique hits also by how much the
               law's own equations differ, integrated here, and with ten times the stiffness along the surface

Force and time of elastic hits are Hertz's. Where all of an oblique hit slips, from a sliding of 7/2 mu (1 + e) V at the contact on, the
normal impulse J = m (1 + e) V brings mu J/m along the surface to a body of mass m and 5/2 mu J/(m r) to its spin."""
import functools
import math
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from common import commit, library  # noqa: E402

GLASS = {"young": 4.8e10, "poisson": 0.2, "density": 2800, "friction": 0.35, "restitution": 1}
ALUMINIUM = {"young": 7e10, "poisson": 0.3, "density": 2700, "friction": 0, "restitution": 1}
SLIDING = {**ALUMINIUM, "poisson": 0.33, "friction": 0.4, "restitution": 0.5}
OXIDE = {"young": 3.8e11, "poisson": 0.23, "density": 4000, "friction": 0.092, "restitution": 0.98}
STEEL = {"young": 2.08e11, "poisson": 0.3, "density": 7850, "friction": 0.3, "restitution": 1}
RESTITUTIONS = 0.1, 0.2, 0.4, 0.6, 0.8, 1.0


def told(test, setting, what, found, closed, *integrated):
    print(",".join([f"{test},{setting},{what},{found:.5g},{closed:.5g}", *(f"{100 * (x - 1):.3f}" for x in (found / closed, *integrated))]))


def integrated(alpha, friction=0.0, sliding=0.0, stiffness=0.0):
    """A hit of mass, stiffness and speed 1 with Tsuji's dashpot, a spring along the surface and Coulomb's limit: the speed after it, and
    the impulse along the surface."""
    step, depth, speed, force, won = 1e-3, 0.0, -1.0, 0.0, 0.0
    while True:
        press = max(0.0, depth ** 1.5 - alpha * depth ** 0.25 * speed)
        speed, won = speed + press * step, won + force * step
        depth -= speed * step
        if depth <= 0:
            return speed, won
        force = min(friction * press, max(-friction * press, force + stiffness * math.sqrt(depth) * sliding * step))
        sliding -= 3.5 * force * step


@functools.lru_cache
def dashpot(e):
    low, high = 0.0, 5.0
    for _ in range(40):
        alpha = (low + high) / 2
        low, high = (alpha, high) if integrated(alpha)[0] > e else (low, alpha)
    return low


def share(material, times, more):
    """Of the impulse along the surface of gross slip."""
    e, friction, poisson = material["restitution"], material["friction"], material["poisson"]
    whole = friction * (1 + e)
    return integrated(dashpot(e), friction, times * 3.5 * whole, more * 3 * (1 - poisson) / (2 - poisson))[1] / whole


def hit(material, upper, lower, speed, slip=0.0, spin=0.0, approach=1.0):
    """A sphere of radius upper falls with `speed`, `slip` along the surface and `spin` on a plane (lower 0) or a sphere that meets it
    with `approach` times that speed and turns as fast at its surface. Returns both after the hit, and its force and time."""
    world = library().World("hertz", gravity=(0, 0, 0), steps_per_contact=100)
    grain = world.add_material(**material)
    gap = 1e-6 * upper
    world.add_body(library().Particle.sphere(upper), grain, position=(0, 0, upper + gap), velocity=(slip, 0, -speed), angular_velocity=(0, spin, 0))
    if lower:
        world.add_body(library().Particle.sphere(lower), grain, position=(0, 0, -lower), velocity=(0, 0, approach * speed),
                       angular_velocity=(0, spin * upper / lower, 0))
    else:
        world.add_wall("plane", grain)
    deepest = time = 0.0
    while not deepest or world.observe().pair_count:
        world.step()
        deepest, time = max(deepest, world.observe().largest_overlap), time + world.time_step * (world.observe().pair_count > 0)
    return [world.body(k) for k in range(len(world))], deepest, time


def elastic(test, material, radius, speed, two):
    """Of two spheres that meet, or of one on a plane as stiff."""
    _, deepest, time = hit(material, radius, radius if two else 0, speed)
    mass = material["density"] * 4 / 3 * math.pi * radius ** 3 * (0.5 if two else 1)
    way, stiff = speed * (2 if two else 1), 2 / 3 * material["young"] / (1 - material["poisson"] ** 2) * math.sqrt(radius * (0.5 if two else 1))
    closed = (1.25 * mass * way * way / stiff) ** 0.4
    told(test, "", "largest force (N)", stiff * deepest ** 1.5, stiff * closed ** 1.5)
    told(test, "", "time of contact (s)", time, 2.9432 * closed / way)


def bounced(test, material, radius, speed, two):
    for e in RESTITUTIONS:
        bodies, _, _ = hit({**material, "friction": 0, "restitution": e}, radius, radius if two else 0, speed)
        told(test, f"e {e:g}", "restitution", bodies[0].velocity[2] / speed, e)


def slipped(test, material, upper, lower, speed, rows, approach):
    """rows: the sliding at the contact over the least for gross slip, and whether the upper sphere moves along or spins."""
    for times, moves in rows:
        e, friction = material["restitution"], material["friction"]
        closing = speed * (1 + approach if lower else 1)
        mass = [material["density"] * 4 / 3 * math.pi * r ** 3 for r in (upper, lower) if r]
        common = 1 / sum(1 / m for m in mass)
        sliding, impulse = times * 3.5 * friction * (1 + e) * closing, friction * (1 + e) * closing * common
        slip, spin = (sliding, 0.0) if moves else (0.0, sliding / upper / (2 if lower else 1))
        bodies, _, _ = hit(material, upper, lower, speed, slip, spin, approach)
        both = [share(material, times, more) for more in (1, 10)]
        setting = f"slides {times:.2f} times the least"
        for k, (body, r) in enumerate(zip(bodies, (upper, lower))):
            won = (-1 if moves else 1 if k == 0 else -1) * impulse / mass[k]
            told(test, setting, "won along the surface (m/s)", float(body.velocity[0]) - (slip if k == 0 else 0), won, *both)
            turned = float(body.angular_velocity[1]) - spin * (1 if k == 0 else upper / lower)
            told(test, setting, "spin won (rad/s)", turned, (1 if moves else -1) * 2.5 * impulse / mass[k] / r, *both)


def main():
    print(f"# commit {commit()}; hits.py\ntest,setting,what,scree,closed_form,differs_percent,equations_percent,stiffer_percent")
    elastic(1, GLASS, 0.01, 10, True)
    elastic(2, ALUMINIUM, 0.1, 0.2, False)
    bounced(3, OXIDE, 0.0025, 3.9, False)
    for degrees in (35, 45, 60, 75, 85):
        normal, least = 3.9 * math.cos(math.radians(degrees)), 3.5 * OXIDE["friction"] * (1 + OXIDE["restitution"])
        slipped(4, OXIDE, 0.0025, 0, normal, [(math.tan(math.radians(degrees)) / least, True)], 0)
    slipped(5, STEEL, 1e-5, 0, 5, [(1.05, True), (2, True), (5, True)], 0)
    slipped(6, SLIDING, 0.1, 0, 0.2, [(1.05, False), (2, False), (5, False)], 0)
    slipped(7, SLIDING, 0.1, 0.1, 0.2, [(1.05, False), (2, False), (5, False)], 1)
    slipped(8, SLIDING, 0.1, 0.05, 0.2, [(1.05, False), (2, False), (5, False)], 0)
    bounced(9, OXIDE, 0.0025, 3.9, True)


if __name__ == "__main__":
    if len(sys.argv) > 1:
        sys.exit(__doc__)
    main()
