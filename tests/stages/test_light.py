# SPDX-License-Identifier: GPL-3.0-or-later
"""Drawn light: its amounts against every ray by hand, its bytes against themselves, what scenes and jobs may be."""

from dataclasses import replace

import kept
import numpy as np
import pytest
from encre.pen import irradiance, library
from encre.pen.errors import EncreError
from encre.pen.job import Bend, Frame, Lamp, Mesh
from encre.pen.scene import Scene
from lamps import CUBE, CUBE_CORNERS, LAMPS, PLANE_CORNERS, Stage, ball, look, moved, perspective, ways
from reference import light as reference


@pytest.mark.parametrize("name", [
    pytest.param(name, marks=pytest.mark.long if name in ("disc", "ellipse") else ()) for name in LAMPS])
def test_as_every_ray_by_hand(name):
    stage, lamp = Stage(36, 24, smooth=True), LAMPS[name]
    light, plain, triangle, _ = kept.of(reference.draw, stage.world, lamp, stage.view, stage.projection, 36, 24)
    found = stage.light(lamp)
    assert (found == found[..., :1]).all()
    there, bright = triangle >= 0, plain.max()
    with np.errstate(all="ignore"):
        share = np.where(plain > 0, light / plain, 1)
    # Within 2 pixels of where shadows begin and end, and on the ball's facets, both mean something else than a pixel's
    # centre.
    flat = np.ones_like(there)
    for y in range(-2, 3):
        for x in range(-2, 3):
            beside = np.roll(share, (y, x), (0, 1))
            flat &= abs(beside - share) < 0.02
    flat &= there
    error = abs(found[..., 0] - light) / bright
    assert flat.sum() > 200
    assert error[flat].mean() < 1e-3 and np.percentile(error[flat], 99) < 0.01
    assert error[there].mean() < 0.02


def test_what_light_reaches():
    """Beside, above and under a cube; a way ends where it ends, and only its own set of shadows counts."""
    scene = Scene()
    scene.geometry(0, CUBE, CUBE_CORNERS)
    scene.instance(0, 0, shadow_sets=1 << 3)
    low, high = CUBE.min(0), CUBE.max(0)
    under, up = (low + high) / 2 - (0, 0, 5), np.array((0, 0, 100.0))
    places = np.array([under, under, under + (9, 0, 0), high + 1])
    ways = np.array([up, up / 50, up, up])
    assert scene.reached(places, ways, 3).tolist() == [False, True, True, True]
    assert scene.reached(places, ways).all() and len(scene.reached(places[:0], ways[:0])) == 0
    with pytest.raises(EncreError, match="^reach: .* shadow_set 64;"):
        scene.reached(places, ways, 64)
    with pytest.raises(EncreError, match="^reach: 4 places, but 3 ways;"):
        scene.reached(places, ways[:3])


@pytest.mark.parametrize("name", ["sun", "wide sun", "point", "ball", "rectangle"])
def test_a_large_triangle_hides_what_its_parts_hide(name):
    """All of a lamp from many pixels at once, and part of it from those about the rim."""
    found = []
    for n in (1, 32):
        stage = Stage(96, 64, eye=(1, -9, 7))
        x, y = np.meshgrid(np.linspace(-2, 3, n + 1), np.linspace(-1, 2, n + 1))
        k = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
        corners = np.concatenate([np.stack([k, k + 1, k + n + 2], 1), np.stack([k, k + n + 2, k + n + 1], 1)])
        stage.add(np.stack([x, y, 2.5 + 0 * x], -1).reshape(-1, 3).astype(np.float32), corners.astype(np.int32),
                  np.eye(4))
        found.append(stage.light(LAMPS[name])[..., 0])
    whole, parts = found
    assert (whole == 0).sum() > 100 and (whole > 0).sum() > 1000
    assert (whole == parts).mean() > 0.995 and abs(whole - parts).max() < 0.02 * whole.max()


@pytest.mark.parametrize("seed", range(3))
def test_triangles_in_a_cloud_are_lit_where_ways_are_free(seed):
    """By a hard sun: pixels of one triangle about which all ways to it are free, or none."""
    rng, stage, lamp = np.random.default_rng(seed), Stage(180, 120, (0, -7, 6), at=(0, 0, 0)), Lamp("sun", model=ways())
    n = 200
    cloud = rng.uniform((-3, -3, 0.5), (3, 3, 2.5), (n, 1, 3)) + 0.35 * rng.normal(size=(n, 3, 3))
    stage.add(cloud.reshape(-1, 3).astype(np.float32), np.arange(3 * n, dtype=np.int32).reshape(-1, 3), np.eye(4))
    stage.meshes[-1].material = np.arange(n, dtype=np.int32) + 1
    maps = library.raster(stage.meshes, stage.view, stage.projection, Frame(180, 120), (180, 120), 0.1,
                          outputs=("depth", "normal", "material"))
    y, x = np.mgrid[:120, :180] + 0.5
    eye, lens = np.linalg.inv(stage.view), np.diagonal(stage.projection)
    sight = np.stack([(x / 90 - 1) / lens[0], (1 - y / 60) / lens[1], -np.ones_like(x)], -1) @ eye[:3, :3].T
    places, sun = eye[:3, 3] + sight * maps["depth"][..., None] + 1e-3 * maps["normal"], lamp.model[:3, 2]
    free = stage.scene.reached(places.reshape(-1, 3), np.full((x.size, 3), 20 * sun)).reshape(x.shape)
    plain = maps["normal"] @ sun
    whole = (maps["material"] > 0) & (plain > 0.1)
    lit, none = whole & free, whole & ~free
    for shift in np.ndindex(3, 3):
        beside = [np.roll(a, np.subtract(shift, 1), (0, 1)) for a in (maps["material"], free)]
        lit &= (beside[0] == maps["material"]) & beside[1]
        none &= (beside[0] == maps["material"]) & ~beside[1]
    found = np.pi * stage.light(lamp)[..., 0]
    assert lit.sum() > 200 and none.sum() > 200
    assert (abs(found - plain)[lit] > 0.01).mean() < 0.01 and (found[none] > 0.01).mean() < 0.01


@pytest.mark.parametrize("name", ["sun", "point", "rectangle"])
def test_light_far_from_the_origin_is_as_clean_as_near_it(name):
    """A million away floats lie as far apart as pixels do here."""
    near, far, lamp = Stage(90, 60, smooth=True), Stage(90, 60, smooth=True), LAMPS[name]
    away = moved(1e6, -3e5, 2e4)
    far.view = near.view @ np.linalg.inv(away)
    for thing in far.meshes:
        thing.model = away @ thing.model
    far._given = [(*first, away @ model, seen) for *first, model, seen in far._given]
    depth = near.depth()
    bend = Bend(moved(2.6, -0.6, 0.8), 1, 0.2)
    one, other = (stage.light(replace(lamp, model=at @ lamp.model), depth=depth, clip_end=100,
                              bends=[replace(bend, model=at @ bend.model)])
                  for stage, at in ((near, np.eye(4)), (far, away)))
    apart = abs(one - other).max(2) / one.max()
    assert (apart > 0.01).mean() < 1e-3 and apart.mean() < 1e-4


def squashed(at, size):
    """A ball of radius 1 -> an ellipsoid about a place, turned."""
    turn = np.linalg.qr(np.random.default_rng(4).normal(size=(3, 3)))[0]
    model = np.eye(4)
    model[:3, :3], model[:3, 3] = turn @ np.diag(size), at
    return model


ABOUT = [Bend(squashed((0, 0, 1.0), (2.2, 1.9, 2.4)), 1.0, 0.3),
         Bend(squashed((2.4, -0.6, 0.9), (1.3, 1, 1)), 0.6, 0.0)]


@pytest.mark.parametrize("name", ["sun", "point"])
def test_ellipsoids_bend_light(name):
    """About the cube as about a face, and about the ball; the plane below lies in both."""
    stage, lamp = Stage(36, 24, smooth=True), LAMPS[name]
    light, plain, triangle, _ = kept.of(reference.draw, stage.world, lamp, stage.view, stage.projection, 36, 24, 1,
                                        ABOUT)
    found, straight = stage.light(lamp, bends=ABOUT)[..., 0], stage.light(lamp)[..., 0]
    there = triangle >= 0
    error = abs(found - light) / plain.max()
    assert np.percentile(error[there], 90) < 0.02 and error[there].mean() < 0.02
    assert error[there].mean() < 0.5 * abs(straight - light)[there].mean() / plain.max()
    unbent = [Bend(ABOUT[0].model, 0.0), Bend(np.zeros((4, 4)))]
    assert (stage.light(lamp, bends=unbent)[..., 0] == straight).all()


def test_an_ellipsoid_throws_one_clean_shadow_over_what_is_in_it():
    """A cube in a ball is lit as the ball is, its corners throw nothing on it, and it on the plane as before."""
    stage, lamp = Stage(64, 48), LAMPS["sun"]
    model = moved(0, 0, 1.0, 1.8)
    found, straight, number = stage.light(lamp, bends=[Bend(model)])[..., 0], stage.light(lamp)[..., 0], stage.objects()
    cube, at = number == 2, reference.surfaces(stage.world, stage.view, stage.projection, 64, 48)[1].reshape(48, 64, 3)
    ahead = reference.unit(at - model[:3, 3]) @ np.asarray(lamp.model)[:3, 2]
    np.testing.assert_allclose(found[cube], np.maximum(ahead, 0)[cube] / np.pi, atol=2e-3)
    far = (number == 1) & (np.linalg.norm(at - model[:3, 3], axis=-1) > 2.1)
    assert (found[far] == straight[far]).mean() > 0.99 and (straight[far] == 0).any()


@pytest.mark.parametrize("bend", [Bend(np.full((4, 4), np.nan)), Bend(np.eye(4), 1.5), Bend(np.eye(4), 1, -0.1)])
def test_ellipsoids_that_are_none_are_refused(bend):
    with pytest.raises(EncreError, match="ellipsoid 1"):
        Stage(8, 8).light(LAMPS["sun"], bends=[Bend(np.eye(4)), bend])
    with pytest.raises(EncreError, match="give 0 to 64"):
        Stage(8, 8).light(LAMPS["sun"], bends=[Bend(np.eye(4))] * 65)


def test_without_shadows():
    stage = Stage(32, 20)
    lamp = Lamp("sun", shadows=False, model=ways())
    plain = kept.of(reference.draw, stage.world, lamp, stage.view, stage.projection, 32, 20)[1]
    assert np.allclose(stage.light(lamp)[..., 0], plain, atol=1e-5)


def test_lamps_add_up_in_their_colours():
    stage = Stage(32, 20)
    one, other = Lamp("sun", (1, 0.5, 0.25), model=ways()), Lamp("point", (0, 90, 10), model=ways(-3.0))
    alone = []
    for lamp in (one, other):
        alone.append(stage.light(lamp))
    assert np.allclose(stage.light(one, other), alone[0] + alone[1], rtol=1e-5, atol=1e-6)


def test_many_lamps_give_nearly_what_each_gives_alone():
    stage = Stage(96, 60)
    lamps = [Lamp("point", (40.0 / (1 + k % 4) ** 3,) * 3, width=0.4, model=ways(2.0 * (k % 3) - 2, y=k / 2 - 3.0))
             for k in range(12)]
    alone = sum(stage.light(lamp).astype(float) for lamp in lamps)
    together = stage.light(*lamps)
    apart = np.abs(together - alone).max(2) / alone.max()
    assert (together != alone.astype(np.float32)).mean() > 0.02  # weak ones are asked less
    assert apart.mean() < 1e-3 and np.percentile(apart, 99) < 0.01 and apart.max() < 0.1


# ---- the same bytes


@pytest.mark.parametrize("name", ["sun", "wide sun", "soft spot", "rectangle"])
def test_same_bytes_on_any_threads_and_instructions(name):
    stage = Stage(101, 67, smooth=True)
    first = stage.light(LAMPS[name], threads=1)
    for options in (dict(threads=3), dict(threads=7), dict(threads=2, simd=0)):
        assert (stage.light(LAMPS[name], **options) == first).all()


def test_edges_beside_edges_are_the_same_whichever_thread_comes_first():
    """Of a cloud's penumbrae of a few pixels many have another edge beside them, or lie in half a shadow."""
    rng, stage = np.random.default_rng(2), Stage(180, 120, (0, -7, 6), at=(0, 0, 0))
    n = 300
    cloud = rng.uniform((-3, -3, 0.2), (3, 3, 1.5), (n, 1, 3)) + 0.3 * rng.normal(size=(n, 3, 3))
    stage.add(cloud.reshape(-1, 3).astype(np.float32), np.arange(3 * n, dtype=np.int32).reshape(-1, 3), np.eye(4))
    lamp = Lamp("sun", width=0.12, model=ways())
    first = stage.light(lamp, threads=1)
    for threads in (2, 3, 5, 8):
        assert (stage.light(lamp, threads=threads) == first).all(), threads


@pytest.mark.parametrize("name", ["sun", "rectangle"])
def test_a_border_is_its_part_of_the_frame(name):
    stage = Stage(160, 96, smooth=True)
    depth = stage.depth()
    whole = stage.light(LAMPS[name], depth=depth)
    for x, y, width, height in ((0, 0, 160, 96), (37, 21, 60, 41), (70, 50, 1, 1), (101, 3, 59, 90), (60, 9, 1, 60),
                                (20, 50, 133, 1), (64, 40, 8, 8), (63, 41, 17, 9)):
        part = stage.light(LAMPS[name], depth=depth[y:y + height, x:x + width], frame=Frame(160, 96, x, y))
        assert (part == whole[y:y + height, x:x + width]).all()


def test_sharp_shadows_are_those_of_a_lamp_without_a_size():
    stage, lamp = Stage(160, 96, smooth=True), LAMPS["wide sun"]
    depth, hard = stage.depth(), replace(lamp, width=0)
    sharp, expected = stage.light(lamp, depth=depth, sharp=True), stage.light(hard, depth=depth)
    close = np.abs(sharp - expected) < 0.02 * expected.max()
    assert close.mean() > 0.97, close.mean()  # amounts differ where the lamp stands at the horizon
    assert np.abs(sharp - stage.light(lamp, depth=depth)).max() > 0.2 * expected.max()
    assert (stage.light(hard, depth=depth, sharp=True) == expected).all()


def test_half_of_the_sky_has_no_sharp_shadows():
    stage, sky = Stage(64, 48, smooth=True), Lamp("sun", (1, 1, 1), width=np.pi, matt=True)
    depth = stage.depth()
    soft, sharp = stage.light(sky, depth=depth), stage.light(sky, depth=depth, sharp=True)
    open_sky = stage.light(replace(sky, shadows=False), depth=depth)
    assert (sharp == open_sky).all()
    assert (soft < 0.7 * open_sky).mean() > 0.02


# ---- the scene


def test_what_is_replaced_and_removed_leaves_nothing():
    stage, lamp = Stage(64, 40), LAMPS["sun"]
    before = stage.light(lamp)
    stage.scene.geometry(9, CUBE, CUBE_CORNERS)
    stage.scene.instance(9, 9, moved(1.5, 1, 3))
    stage.scene.lamp(5, LAMPS["rectangle"])
    assert (stage.light() != before).any()
    stage.scene.lamp(5, None)
    stage.scene.instance(9, 9, moved(50, 0, -50))
    assert (stage.light() == before).all()
    stage.scene.geometry(1, CUBE * 1.5, CUBE_CORNERS)  # in place of what an instance shows
    assert (stage.light() != before).any()
    stage.scene.geometry(1, CUBE, CUBE_CORNERS)
    stage.scene.instance(9, None)
    stage.scene.geometry(9, None)
    stage.scene.geometry(77, None)  # was never there
    assert (stage.light() == before).all()


def test_keys_come_and_go_in_any_order():
    one, other = Stage(24, 16), Stage(24, 16)
    lamps = {key: Lamp("sun", (1 + key, 2.0, 1 / key), model=ways(x=1.0 + key)) for key in range(1, 10)}
    for key in (6, 2, 9, 4, 1, 8, 3, 7, 5):
        one.scene.lamp(key, lamps[key])
    for key in (4, 9, 1):
        one.scene.lamp(key, None)
    for key in (2, 3, 5, 6, 7, 8):
        other.scene.lamp(key, lamps[key])
    assert (one.light() == other.light()).all() and one.light().max() > 0


def test_instances_share_geometry_and_may_be_mirrored():
    points, corners, normals = ball()
    places = [moved(2.5, -1, 1), moved(-2.5, -1, 1) @ np.diag([-1.0, 1.2, 0.7, 1])]
    shared, alone = Stage(40, 25), Stage(40, 25)
    for place in places:
        alone.add(points, corners, place, normals)
    shared.meshes = alone.meshes
    shared.scene.geometry(2, points, corners, normals)
    for k, place in enumerate(places):
        shared.scene.instance(2 + k, 2, place)
    lamp = LAMPS["wide sun"]
    found = shared.light(lamp)
    assert (found == alone.light(lamp)).all()
    expected, _, triangle, _ = kept.of(reference.draw, alone.world, lamp, alone.view, alone.projection, 40, 25, 6)
    assert abs(found[..., 0] - expected)[triangle >= 0].mean() < 0.01


def test_sets_say_what_is_lit_and_what_throws_shadows():
    stage = Stage(96, 60)
    lamp = LAMPS["sun"]
    everything = stage.light(lamp)[..., 0]
    image = stage.objects()
    stage.scene.instance(1, 1, moved(0, 0, 1.001), shadow_sets=~(1 << 3) & (2 ** 64 - 1))
    assert (stage.light(lamp)[..., 0] == everything).all()
    lamp = Lamp("sun", model=ways(), light_set=5, shadow_set=3)
    without = stage.light(lamp)[..., 0]
    assert (without[image == 1] > 0).all() and (everything[image == 1] == 0).any()
    stage.scene.instance(0, 0, light_sets=1)
    lit = stage.light(lamp)[..., 0]
    assert (lit[image == 1] == 0).all() and (lit[image == 2] == without[image == 2]).all()


def test_what_is_not_solid_lets_light_through():
    """A leaf over the plane, a disc cut out of it by its texture, throws the shadow of a disc."""
    stage = Stage(160, 96, eye=(0, -1, 14), at=(0, 0, 0))
    stage.scene.instance(1, None)
    stage.meshes.pop()
    n = 64
    y, x = (np.mgrid[:n, :n] + 0.5) / n
    disc = np.clip(128 + 400 * (0.3 - np.hypot(x - 0.5, y - 0.5)) * 4, 0, 255)
    stage.scene.texture(7, disc.astype(np.uint8))
    leaf = np.array([[-2, -2, 2], [2, -2, 2], [2, 2, 2], [-2, 2, 2]], np.float32)
    uvs = np.array([[[0, 0], [1, 0], [1, 1]], [[0, 0], [1, 1], [0, 1]]], np.float32)
    lamp = Lamp("sun", model=look((0, 0, 5), (0, 0.01, 0)))
    depth = stage.depth()

    def shadow(textures, uvs=uvs):
        stage.scene.geometry(9, leaf, PLANE_CORNERS, uvs=uvs, textures=np.array(textures, np.int32))
        stage.scene.instance(9, 9, camera=False)
        return stage.light(lamp, depth=depth)[..., 0] < 0.5 / np.pi

    plain = shadow([-1, -1])
    assert (shadow([3, 3]) == plain).all()  # not there: solid
    cut, half = shadow([7, 7]), shadow([7, -1])
    assert cut.sum() == pytest.approx(np.pi * 1.2**2 / 16 * plain.sum(), rel=0.03)
    assert half.sum() == pytest.approx((plain.sum() + cut.sum()) / 2, rel=0.03)
    many = shadow([7, 7], uvs * 4 - 1)
    assert many.sum() == pytest.approx(cut.sum(), rel=0.05) and (many != cut).any()
    stage.scene.texture(7, disc.astype(np.uint8), "CLIP")
    assert shadow([7, 7], uvs * 4 - 1).sum() == pytest.approx(cut.sum() / 16, rel=0.3)
    stage.scene.texture(7, np.full((1, 1), 255, np.uint8), "EXTEND", closest=True)
    assert (shadow([7, 7], uvs * 4 - 1) == plain).all()
    stage.scene.texture(7, np.zeros((3, 5), np.uint8))
    assert not shadow([7, 7]).any()
    uvs[0, 0] = np.nan
    assert shadow([7, 7]).any()  # where it is can't be told: solid


def test_what_the_camera_does_not_see_throws_shadows():
    stage = Stage(96, 60)
    before = stage.light(LAMPS["sun"])[..., 0]
    stage.scene.geometry(7, CUBE, CUBE_CORNERS)
    stage.scene.instance(7, 7, moved(3, -1, 2.5, 0.5), camera=False)
    after = stage.light(LAMPS["sun"])[..., 0]
    assert (after <= before + 1e-6).all() and (after < 0.1 * before).sum() > 50


def test_light_from_all_sides_goes_by_the_normal():
    stage = Stage(48, 32, smooth=True)
    by = np.random.default_rng(4).uniform(-0.3, 1, (9, 3))
    triangle, _, normal, _ = reference.surfaces(stage.world, stage.view, stage.projection, 48, 32)
    there = (triangle >= 0).reshape(32, 48)
    want = np.maximum(irradiance.polynomials(normal) @ by, 0).reshape(32, 48, 3)
    error = np.abs(stage.light(world=by) - want).max(-1)[there]
    assert there.sum() > 500 and (error < 1e-4).mean() > 0.9, np.percentile(error, (50, 90, 95, 99))


def test_light_from_all_sides():
    stage = Stage(64, 40, smooth=True)
    color = np.array([0.2, 0.4, 0.1])
    found = stage.light(world=irradiance.constant(color))
    assert np.allclose(found[stage.depth() < 1e9], color, atol=1e-6)
    # Light from above alone, as bright as the sine of its height: what falls on the ground is 2/3 of it.
    height = np.sin(np.pi * (0.5 - (np.arange(90) + 0.5) / 90))
    picture = np.repeat(np.maximum(height, 0)[:, None, None], 180, 1).repeat(3, 2)
    by = irradiance.of_picture(picture)
    assert np.allclose(irradiance.polynomials(np.array([0, 0, 1.0])) @ by, 2 / 3, atol=0.01)
    east = np.zeros((90, 180, 3))
    east[:, 80:100] = 1  # the middle of the picture lies towards +x
    assert (irradiance.polynomials(np.array([1.0, 0, 0])) @ irradiance.of_picture(east) > 0.1).all()
    turned = irradiance.of_picture(east, np.array([[0, 1, 0], [-1, 0, 0], [0, 0, 1.0]]))
    assert np.allclose(irradiance.polynomials(np.array([0, 1.0, 0])) @ turned,
                       irradiance.polynomials(np.array([1.0, 0, 0])) @ irradiance.of_picture(east), atol=1e-3)


# ---- what is unusual


def test_what_is_not_in_the_scene_is_told_by_depth_and_normal():
    stage, lamp = Stage(64, 40), Lamp("sun", model=ways())
    normal = np.zeros((40, 64, 3), np.float32)
    normal[...] = 0, 0, 1
    expected = stage.light(lamp)
    depth = stage.depth()
    stage.scene.instance(0, None)  # the plane goes; its depth stays
    found = stage.light(lamp, depth=depth, normal=normal)
    image = stage.objects()
    inner = image == 1
    assert abs(found - expected)[inner].mean() < 2e-3


def test_nothing_comes_out_that_is_not_finite():
    stage = Stage(40, 30)
    rng = np.random.default_rng(0)
    points = CUBE.copy()
    points[3], points[6] = np.nan, np.inf
    stage.scene.geometry(5, points, CUBE_CORNERS)
    stage.scene.instance(5, 5, moved(0, 0, 2))
    stage.scene.instance(6, 1, np.zeros((4, 4)))
    stage.scene.instance(7, 1, np.full((4, 4), np.nan))
    stage.scene.instance(8, 1, np.diag([1e30, 1e30, 1e30, 1.0]))
    depth = stage.depth()
    depth[rng.random(depth.shape) < 0.2] = np.nan
    depth[rng.random(depth.shape) < 0.2] = np.inf
    depth[rng.random(depth.shape) < 0.2] = -3
    depth[rng.random(depth.shape) < 0.2] = 1e8
    normal = rng.normal(size=(30, 40, 3)).astype(np.float32)
    normal[rng.random(depth.shape) < 0.3] = np.nan
    lamps = [*LAMPS.values(), Lamp("point", (3e38,) * 3, width=1e-20), Lamp("sun", model=np.zeros((4, 4))),
             Lamp("rectangle", (1e30,) * 3, width=1e-30, height=1e20), Lamp("spot", spot_angle=0, model=ways()),
             *[Lamp("sun", (3e38,) * 3, model=ways())] * 9, Lamp("sun", (-3e38,) * 3, model=ways(-3.0))]
    found = stage.light(*lamps, depth=depth, normal=normal)
    assert np.isfinite(found).all() and (found >= 0).all()
    assert all({0, np.finfo(np.float32).max} <= set(channel.ravel()) for channel in np.moveaxis(found, 2, 0))


@pytest.mark.parametrize("kind", ["point", "spot", "ellipse"])
def test_a_lamp_of_a_size_that_is_no_number_gives_no_light(kind):
    stage, model = Stage(12, 9), ways()
    depth = stage.depth()
    for k in range(3):
        huge = model.copy()
        huge[:3, k] *= 1e25
        assert (stage.light(Lamp(kind, width=0.1, height=0.1, spot_angle=2.0, model=huge), depth=depth) == 0).all()
    assert stage.light(Lamp(kind, width=0.1, height=0.1, spot_angle=2.0, model=model), depth=depth).max() > 0


def test_an_empty_scene_is_dark():
    scene, depth = Scene(), np.full((5, 7), 3, np.float32)
    light = scene.light(depth, None, np.eye(4), perspective(7, 5), Frame(7, 5), 0.1)
    assert (light == 0).all()


def test_a_pixel_beside_a_thing_takes_its_light():
    scene = Scene()
    scene.geometry(0, CUBE, CUBE_CORNERS)
    scene.instance(0, 0)
    scene.lamp(0, Lamp("sun", model=look((3, -5, 6), (0, 0, 0))))
    view, projection = np.linalg.inv(look((0, -9, 0.01), (0, 0, 0))), perspective(60, 40)
    depth = library.raster([Mesh(CUBE, CUBE_CORNERS, object_index=1)], view, projection, Frame(60, 40), (60, 40), 0.1,
                           outputs=("depth",))["depth"]
    light = scene.light(depth, None, view, projection, Frame(60, 40), 0.1)[..., 0]
    there = depth < 1e9
    left = there.any(0).argmax()
    assert there[20, left] and light[20, left] > 0
    assert light[20, left - 2] == light[20, left] and light[20, left - 3] == 0
