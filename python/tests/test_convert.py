"""IFC models become GLB with names, keys, types and paths."""

import subprocess
import sys

import impinge
import numpy as np
import pytest
from impinge.convert import ConversionError, convert


def walls(path):
    """Writes a model of two walls that share a shape, in UTM coordinates. Returns their GlobalIds."""
    pytest.importorskip("ifcopenshell", reason="ifcopenshell is not installed")
    from ifcopenshell.api import aggregate, context, geometry, project, root, spatial, unit

    model = project.create_file()
    top = root.create_entity(model, ifc_class="IfcProject", name="House")
    unit.assign_unit(model)
    whole = context.add_context(model, context_type="Model")
    named = {"context_identifier": "Body", "target_view": "MODEL_VIEW", "parent": whole}
    body = context.add_context(model, context_type="Model", **named)
    storey = root.create_entity(model, ifc_class="IfcBuildingStorey", name="Ground floor")
    aggregate.assign_object(model, products=[storey], relating_object=top)
    shape = geometry.add_wall_representation(model, context=body, length=5, height=3, thickness=0.2)
    ids = []
    for number, shown in enumerate((shape, geometry.map_representation(model, representation=shape))):
        wall = root.create_entity(model, ifc_class="IfcWall", name=f"W{number}")
        place = np.array(impinge.pose([500000 + 4.5 * number, 5.4e6, 0]))
        geometry.edit_object_placement(model, product=wall, matrix=place)
        geometry.assign_representation(model, product=wall, representation=shown)
        spatial.assign_container(model, products=[wall], relating_structure=storey)
        ids.append(wall.GlobalId)
    model.write(str(path))
    return ids


def test_an_ifc_model_keeps_names_keys_types_paths_and_millimeters(tmp_path):
    ids = walls(tmp_path / "house.ifc")
    command = [sys.executable, "-m", "impinge.convert", str(tmp_path / "house.ifc")]
    subprocess.run(command, check=True, capture_output=True)
    scene = impinge.load_scene(tmp_path / "house.glb", origin=[500000, 5.4e6, 0])
    assert list(scene.parts) == ["W0", "W1"]
    assert scene.parts["W0"] is scene.parts["W1"]
    assert [scene.details(name).key for name in scene.parts] == ids
    assert scene.details("W1").type == "IfcWall"
    assert scene.details("W1").path == ("House", "Ground floor")
    assert scene.poses["W1"][:3, 3].tolist() == [4.5, 0, 0]
    assert np.allclose(scene.parts["W0"].vertices.max(axis=0), [5, 0.2, 3])
    assert scene.check(question="penetrates").names() == [("W0", "W1")]


def test_errors_say_what_is_missing(tmp_path, monkeypatch):
    model = tmp_path / "a.ifc"
    with pytest.raises(FileNotFoundError):
        convert(model, tmp_path / "a.glb")
    model.write_text("ISO-10303-21;")
    with pytest.raises(impinge.InputError, match="impinge.convert"):
        impinge.load_scene(model)
    for name, extra in [("a.ifc", "ifc"), ("a.stp", "step")]:
        (tmp_path / name).write_text("ISO-10303-21;")
        for module in ("ifcopenshell", "OCP", "OCP.BRep", "impinge.convert._ifc", "impinge.convert._step"):
            monkeypatch.setitem(sys.modules, module, None)
        monkeypatch.delitem(sys.modules, "impinge.convert._ifc")
        monkeypatch.delitem(sys.modules, "impinge.convert._step")
        with pytest.raises(ConversionError, match=rf"pip install .impinge\[{extra}\]"):
            convert(tmp_path / name, tmp_path / "a.glb")
    with pytest.raises(impinge.InputError, match="extensions are"):
        convert(__file__, tmp_path / "a.glb")
    with pytest.raises(impinge.InputError, match="above zero"):
        convert(model, tmp_path / "a.glb", sag=0)
