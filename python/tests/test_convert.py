"""IFC and STEP models become GLB with names, keys, types and paths."""

import subprocess
import sys

import impinge
import numpy as np
import pytest
from impinge.convert import ConversionError, convert


def walls(path):
    """Writes two walls that share a shape, in UTM coordinates. Returns their GlobalIds."""
    pytest.importorskip("ifcopenshell", reason="ifcopenshell is not installed")
    from ifcopenshell.api import aggregate, context, geometry, project, root, spatial, unit  # noqa: PLC0415

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


def rack(path):
    """Writes an assembly of two pins of one shape, in millimeters."""
    pytest.importorskip("OCP", reason="cadquery-ocp is not installed")
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeCylinder  # noqa: PLC0415
    from OCP.gp import gp_Trsf, gp_Vec  # noqa: PLC0415
    from OCP.STEPCAFControl import STEPCAFControl_Writer  # noqa: PLC0415
    from OCP.TCollection import TCollection_ExtendedString  # noqa: PLC0415
    from OCP.TDataStd import TDataStd_Name  # noqa: PLC0415
    from OCP.TDocStd import TDocStd_Document  # noqa: PLC0415
    from OCP.TopLoc import TopLoc_Location  # noqa: PLC0415
    from OCP.XCAFDoc import XCAFDoc_DocumentTool  # noqa: PLC0415

    document = TDocStd_Document(TCollection_ExtendedString("XCAF"))
    tool = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    pin, top = tool.AddShape(BRepPrimAPI_MakeCylinder(5.0, 20.0).Shape(), False), tool.NewShape()
    TDataStd_Name.Set_s(top, TCollection_ExtendedString("rack"))
    for number in range(2):
        place = gp_Trsf()
        place.SetTranslation(gp_Vec(30.0 * number, 0, 0))
        component = tool.AddComponent(top, pin, TopLoc_Location(place))
        TDataStd_Name.Set_s(component, TCollection_ExtendedString(f"pin {number + 1}"))
    tool.UpdateAssemblies()
    writer = STEPCAFControl_Writer()
    writer.SetNameMode(True)
    writer.Transfer(document)
    writer.Write(str(path))


def test_a_step_assembly_keeps_names_paths_shared_shapes_and_units(tmp_path):
    rack(tmp_path / "rack.step")
    assert convert(tmp_path / "rack.step", tmp_path / "rack.glb", sag=1e-5) == 2
    scene = impinge.load_scene(tmp_path / "rack.glb")
    assert [scene.details(name).key for name in scene.parts] == ["rack/pin 1", "rack/pin 2"]
    pin = scene.parts["pin 1"]
    assert scene.parts["pin 2"] is pin
    assert scene.poses["pin 2"][:3, 3].tolist() == [0.03, 0, 0]
    assert np.allclose(pin.vertices.max(axis=0), [0.005, 0.005, 0.02], atol=1e-5)
    health = pin.health()
    assert (health.open_edges, health.misoriented_edges, health.components) == (0, 0, 1)


def test_errors_say_what_is_missing(tmp_path, monkeypatch):
    model = tmp_path / "a.ifc"
    with pytest.raises(FileNotFoundError):
        convert(model, tmp_path / "a.glb")
    model.write_text("ISO-10303-21;")
    with pytest.raises(impinge.InputError, match=r"impinge\.convert"):
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
