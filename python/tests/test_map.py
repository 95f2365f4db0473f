"""Maps as arrays; saving, localization and export."""

import numpy
import pytest

import alidade
from conftest import play, read


@pytest.fixture(scope="module")
def slam(desk):
    recording, frames = desk
    with alidade.Slam(recording.camera, sensor="rgbd", semidense=True) as made:
        for frame in frames:
            made.track(frame.time, numpy.dstack([frame.image] * 3), depth=frame.depth)
    return made


def test_points_are_seen_where_they_lie(slam):
    made, camera = slam.map(), slam.camera
    keyframes, points, seen = made.keyframes, made.points, made.observations
    assert numpy.all(numpy.diff(keyframes.ids.astype(int)) > 0) and len(points.ids) > 300
    assert keyframes.poses.shape == (len(keyframes.ids), 4, 4)
    T = numpy.linalg.inv(keyframes.poses)[numpy.searchsorted(keyframes.ids, seen.keyframes)]
    p = points.positions[numpy.searchsorted(points.ids, seen.points)]
    p_camera = numpy.einsum("nij,nj->ni", T[:, :3, :3], p) + T[:, :3, 3]
    pixels = p_camera[:, :2] / p_camera[:, 2:] * [camera.fx, camera.fy] + [camera.cx, camera.cy]
    errors = numpy.linalg.norm(pixels - seen.pixels, axis=1)
    assert numpy.median(errors) < 1 and len(errors) == points.seen_by.sum()
    numpy.testing.assert_allclose(numpy.linalg.norm(points.normals, axis=1), 1, atol=1e-4)


def test_covisibility_is_of_keyframes_that_share_points(slam):
    made = slam.map()
    seen = made.observations
    of = {k: set(seen.points[seen.keyframes == k]) for k in made.keyframes.ids}
    edges = {(a, b): shared for a, b, shared in made.covisibility}
    assert made.covisibility.shape == (len(edges), 3) and min(edges.values()) > 0
    for a in made.keyframes.ids:
        for b in made.keyframes.ids[made.keyframes.ids > a]:
            shared = len(of[a] & of[b])
            if shared > 50:  # a stored count, which may be outdated by a fifth
                assert shared / edges[a, b] == pytest.approx(1, abs=0.3)
    assert made.loops.shape[1] == 2


def test_the_cloud_lies_on_the_true_surface(slam, desk):
    recording, frames = desk
    made = slam.map()
    cloud = made.cloud()
    assert cloud.points.shape == cloud.colors.shape == (len(cloud.sigmas), 3) and len(cloud.points) > 1000
    assert 0 < len(made.cloud(voxel=0.05).points) < len(cloud.points)
    pairs = []
    for keyframe, number in zip(made.keyframes.ids, made.keyframes.numbers):
        depth = made.parts[0].depth(keyframe)
        if depth is not None:
            pairs.append((depth[0], frames[number].true_depth, frames[number].image))
            assert numpy.all((depth[1] > 0) == (depth[0] > 0))
    errors = alidade.depth_errors(*zip(*pairs))
    assert errors.all.median_rel < 0.03 and len(errors.frames) == len(pairs) and errors.scales[0] == 1
    with pytest.raises(alidade.UsageError):
        made.parts[0].depth(99999)


def test_saved_loaded_and_gone_on_with(slam, desk, tmp_path):
    recording, frames = desk
    made = slam.map()
    made.save(tmp_path / "map.alidade")
    again = alidade.Map.load(tmp_path)
    assert again.to_bytes() == made.to_bytes() == alidade.Map.from_bytes(made.to_bytes()).to_bytes()
    assert again.sensor == "rgbd" and again.camera == made.camera and again.settings == made.settings
    assert len(again.cloud().points) == 0 and "keyframes" in repr(again)

    with alidade.Slam(recording.camera, sensor="rgbd", localize=True) as found:
        found.load(tmp_path / "map.alidade")
        results = play(found, frames[10:])
    assert results[-1].pose is not None and len(found.map().keyframes.ids) == len(made.keyframes.ids)
    moved = numpy.linalg.inv(frames[0].true_pose) @ frames[-1].true_pose
    assert numpy.abs(results[-1].pose - moved)[:3, 3].max() < 0.03
    with pytest.raises(alidade.InputError):
        alidade.Slam(alidade.Camera(100, 100, 90, 90, 50, 50, depth_factor=1), sensor="rgbd").load(made)
    (tmp_path / "broken").write_bytes(made.to_bytes()[:-1000])
    with pytest.raises(alidade.InputError, match="broken"):
        alidade.Map.load(tmp_path / "broken")


def test_exports_are_those_of_the_program(slam, tmp_path, program):
    slam.save(tmp_path / "map.alidade")
    for name, to in [("a.ply", "ply"), ("a.pcd", "pcd"), ("a.txt", "tum")]:
        said = slam.map().export(tmp_path / name)
        program("export", tmp_path / "map.alidade", tmp_path / f"program-{name}", "--to", to)
        assert read(tmp_path, name) == read(tmp_path, f"program-{name}") and said.split()[1].strip(",") in ("points", "poses")
    slam.map().export(tmp_path / "model", "colmap", format="text", min_observations=2)
    program("export", tmp_path / "map.alidade", tmp_path / "theirs", "--to", "colmap", "--no-images", "--format", "text",
            "--min-observations", 2)
    for name in ("cameras.txt", "images.txt", "points3D.txt"):
        assert read(tmp_path / "model", name) == read(tmp_path / "theirs", name)
    with pytest.raises(alidade.UsageError):
        slam.map().export(tmp_path / "model")
    with pytest.raises(alidade.UsageError, match="numbered"):
        slam.map().export(tmp_path / "b.ply", part=3)


def test_an_empty_map_says_so():
    slam = alidade.Slam(alidade.Camera.from_fov(160, 120, 60))
    assert slam.map().parts == [] and slam.trajectory().shape == (0, 8)
    with pytest.raises(alidade.UsageError, match="empty"):
        _ = slam.map().points


def test_a_map_with_depth_is_metric_and_knows_no_gravity(slam):
    made = slam.map()
    assert made.metric and made.parts[0].metric
    assert made.scale_sigma is None and made.gravity is None and made.gravity_sigma is None
