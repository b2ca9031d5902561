# SPDX-License-Identifier: BSD-3-Clause
"""The notebooks of examples/notebooks run without an error and draw what they say."""
import pathlib

import pytest

NOTEBOOKS = pathlib.Path(__file__).parents[2] / "examples/notebooks"
EXPECTED = {  # pictures, and a text that is printed
    "1_simulate_and_look": (3, "20 scans, 401 samples of the IMU"),
    "2_score_your_slam": (4, "50 poses"),
    "3_choose_a_sensor": (1, "livox_mid360    ok"),
}

nbformat = pytest.importorskip("nbformat", reason="needs python3-nbconvert")
preprocessors = pytest.importorskip("nbconvert.preprocessors", reason="needs python3-nbconvert")
pytest.importorskip("ipykernel", reason="needs python3-ipykernel")
pytest.importorskip("matplotlib", reason="needs python3-matplotlib")


def test_each_notebook_is_tested():
    assert {file.stem for file in NOTEBOOKS.glob("*.ipynb")} == set(EXPECTED)


@pytest.mark.parametrize("name", EXPECTED)
def test_a_notebook_runs(name, tmp_path):
    notebook = nbformat.read(NOTEBOOKS / f"{name}.ipynb", as_version=4)
    run = preprocessors.ExecutePreprocessor(timeout=600, kernel_name="python3")
    run.preprocess(notebook, {"metadata": {"path": str(tmp_path)}})
    outputs = [out for cell in notebook.cells if cell.cell_type == "code" for out in cell.outputs]
    pictures = [out for out in outputs if "image/png" in out.get("data", {})]
    printed = "".join(out.text for out in outputs if out.output_type == "stream")
    pictures_expected, text = EXPECTED[name]
    assert len(pictures) == pictures_expected and text in printed, printed
