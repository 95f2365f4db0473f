"""Evaluation of arrays, compared with the program's results and with NumPy."""

import json

import numpy
import pytest

import alidade


def trajectories():
    rng = numpy.random.default_rng(4)
    n = 200
    truth = numpy.zeros((n, 8))
    truth[:, 0] = numpy.arange(n) / 10
    truth[:, 1:4] = numpy.cumsum(rng.normal(0, 0.05, (n, 3)), axis=0)
    angles = numpy.cumsum(rng.normal(0, 0.02, n))
    truth[:, 6], truth[:, 7] = numpy.sin(angles / 2), numpy.cos(angles / 2)
    estimate = truth.copy()
    turn = numpy.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    estimate[:, 1:4] = 0.5 * truth[:, 1:4] @ turn.T + [1, 2, 3] + rng.normal(0, 0.01, (n, 3))
    return truth, estimate[rng.permutation(n)[:150]]


def test_ate_is_that_of_the_program_and_of_umeyama(tmp_path, program):
    truth, estimate = trajectories()
    alidade.write_trajectory(tmp_path / "truth.txt", truth)
    alidade.write_trajectory(tmp_path / "estimate.txt", estimate)
    numpy.testing.assert_allclose(alidade.read_trajectory(tmp_path / "truth.txt"), truth, atol=1e-8)
    for align in ("se3", "sim3", "none"):
        ours = alidade.ate(truth, estimate, align=align, association="evo")
        theirs = json.loads(program("evaluate", "ate", tmp_path / "truth.txt", tmp_path / "estimate.txt", "--align",
                                    align, "--association", "evo", "--json"))
        assert ours.align == theirs.pop("align") == align
        del theirs["align_why"]  # names the option
        for name, value in theirs.items():
            assert getattr(ours, name) == pytest.approx(value, abs=1e-6), (align, name)
    # Umeyama 1991, with NumPy's SVD.
    ours = alidade.ate(truth, estimate, align="sim3")
    a, b = truth[ours.pairs[:, 0], 1:4], estimate[ours.pairs[:, 1], 1:4]
    u, d, vt = numpy.linalg.svd((a - a.mean(0)).T @ (b - b.mean(0)) / len(a))
    sign = numpy.diag([1, 1, numpy.sign(numpy.linalg.det(u @ vt))])
    scale = numpy.trace(numpy.diag(d) @ sign) / (b - b.mean(0)).var(0).sum()
    R = u @ sign @ vt
    laid = scale * b @ R.T + a.mean(0) - scale * R @ b.mean(0)
    numpy.testing.assert_allclose(ours.errors, numpy.linalg.norm(laid - a, axis=1), atol=1e-9)
    numpy.testing.assert_allclose(ours.transform[:3, :3], scale * R, atol=1e-9)
    assert ours.scale == pytest.approx(scale)


def test_rpe_is_that_of_the_program(tmp_path, program):
    truth, estimate = trajectories()
    alidade.write_trajectory(tmp_path / "truth.txt", truth)
    alidade.write_trajectory(tmp_path / "estimate.txt", estimate)
    ours = alidade.rpe(truth, estimate, delta=5, unit="frames", pairs="consecutive", align="sim3")
    theirs = json.loads(program("evaluate", "rpe", tmp_path / "truth.txt", tmp_path / "estimate.txt", "--delta", "5f",
                                "--pairs", "consecutive", "--align", "sim3", "--json"))
    for kind in ("trans", "rot"):
        for name, value in theirs[kind].items():
            assert getattr(getattr(ours, kind), name) == pytest.approx(value, abs=1e-6), (kind, name)


def test_depth_errors_are_relative():
    rng = numpy.random.default_rng(2)
    truth = rng.uniform(1, 4, (60, 80)).astype(numpy.float32)
    estimate = (truth * 1.04 / 2).astype(numpy.float32)
    estimate[:30] = 0
    image = rng.integers(0, 255, (60, 80), dtype=numpy.uint8)
    errors = alidade.depth_errors([estimate], [truth], [image]).all
    assert errors.median_rel == pytest.approx(0.48, abs=1e-3) and errors.density == 0.5 and errors.n == 2400
    fitted = alidade.depth_errors([estimate], [truth], [image], fit_scale=True)
    assert fitted.all.median_rel < 1e-6 and fitted.scales[0] == pytest.approx(2 / 1.04)
    with pytest.raises(alidade.UsageError):
        alidade.depth_errors([estimate], [], [image])


def test_what_is_no_trajectory_is_refused():
    truth, estimate = trajectories()
    with pytest.raises(alidade.InputError, match="estimate must be"):
        alidade.ate(truth, estimate[:, :7])
    with pytest.raises(alidade.InputError, match="row 3"):
        estimate[3, 4:] = 0
        alidade.ate(truth, estimate)
    with pytest.raises(alidade.UsageError, match="sim3"):
        alidade.ate(truth, truth, align="sim")
    with pytest.raises(alidade.InputError):
        alidade.ate(truth, "nothing")
