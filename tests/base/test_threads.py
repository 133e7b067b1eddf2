"""Linear algebra takes one thread in a calibration, a diagnosis and a simulated pyramid, whatever the session takes."""

from threadpoolctl import threadpool_info, threadpool_limits

from palpate.base.threads import on_one_thread
from palpate.diagnosis.study_diagnosis import diagnosed
from palpate.inference.calibrate import calibrate
from palpate.solver.pyramid.indent_3d import indent_3d


def blas_threads():
    return {library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas"}


def test_the_session_keeps_its_threads():
    with threadpool_limits(limits=2, user_api="blas"):
        assert blas_threads() == {2}
        assert on_one_thread(blas_threads)() == {1}
        assert blas_threads() == {2}


def test_long_computations_take_one():
    assert all(hasattr(function, "__wrapped__") for function in (calibrate, diagnosed, indent_3d))
