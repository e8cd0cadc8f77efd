"""Draws the largest principal stress of fields on a plate seen from below, at a few times.

python fields_figure.py OUT.vtkhdf FIGURE.png
"""

import sys

import vtk

TIMES = [0.2e-3, 0.5e-3, 1.0e-3, 2.0e-3]  # s
WARP = 150.0
LARGEST = 40.0  # MPa


def text(words, size, x, y):
    """Words at a place of the view."""
    actor = vtk.vtkTextActor()
    actor.SetInput(words)
    style = actor.GetTextProperty()
    style.SetFontSize(size)
    style.SetColor(0, 0, 0)
    actor.GetPositionCoordinate().SetCoordinateSystemToNormalizedViewport()
    actor.SetPosition(x, y)
    return actor


def view(path, time, table):
    """The warped plate at the frame nearest to a time."""
    reader = vtk.vtkHDFReader()
    reader.SetFileName(path)
    reader.UpdateInformation()
    times = reader.GetOutputInformation(0).Get(vtk.vtkStreamingDemandDrivenPipeline.TIME_STEPS())
    nearest = min(times, key=lambda t: abs(t - time))
    reader.UpdateTimeStep(nearest)
    tension = vtk.vtkArrayCalculator()
    tension.SetInputConnection(reader.GetOutputPort())
    tension.AddScalarVariable("s", "principal_stress", 0)
    tension.SetFunction("s / 1e6")
    tension.SetResultArrayName("tension")
    warp = vtk.vtkWarpVector()
    warp.SetInputConnection(tension.GetOutputPort())
    warp.SetInputArrayToProcess(0, 0, 0, vtk.vtkDataObject.FIELD_ASSOCIATION_POINTS, "displacement")
    warp.SetScaleFactor(WARP)
    mapper = vtk.vtkDataSetMapper()
    mapper.SetInputConnection(warp.GetOutputPort())
    mapper.SetScalarModeToUsePointFieldData()
    mapper.SelectColorArray("tension")
    mapper.SetLookupTable(table)
    mapper.SetScalarRange(0, LARGEST)
    mapper.InterpolateScalarsBeforeMappingOn()
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetAmbient(0.45)
    actor.GetProperty().SetDiffuse(0.55)
    renderer = vtk.vtkRenderer()
    renderer.SetBackground(1, 1, 1)
    renderer.AddActor(actor)
    renderer.AddViewProp(text(f"{1e3 * nearest:.2f} ms", 26, 0.06, 0.88))
    camera = renderer.GetActiveCamera()
    camera.SetPosition(-1.2, -2.2, -2.0)
    camera.SetFocalPoint(0, 0, 0)
    camera.SetViewUp(0, 0, 1)
    renderer.ResetCamera()
    camera.Zoom(1.25)
    return renderer


def main():
    path, figure = sys.argv[1:]
    table = vtk.vtkColorTransferFunction()
    for part, colour in [(0.0, (0.96, 0.96, 0.94)), (0.3, (0.99, 0.8, 0.5)), (0.65, (0.85, 0.3, 0.2)), (1.0, (0.3, 0.0, 0.25))]:
        table.AddRGBPoint(part * LARGEST, *colour)
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(8)
    window.SetSize(1400, 900)
    for number, time in enumerate(TIMES):
        renderer = view(path, time, table)
        x, y = 0.44 * (number % 2), 0.5 * (1 - number // 2)
        renderer.SetViewport(x, y, x + 0.44, y + 0.5)
        window.AddRenderer(renderer)
    legend = vtk.vtkRenderer()
    legend.SetBackground(1, 1, 1)
    legend.SetViewport(0.88, 0, 1, 1)
    bar = vtk.vtkScalarBarActor()
    bar.SetLookupTable(table)
    bar.SetTitle("MPa")
    bar.SetNumberOfLabels(5)
    bar.SetLabelFormat("%.0f")
    bar.UnconstrainedFontSizeOn()
    for style in [bar.GetTitleTextProperty(), bar.GetLabelTextProperty()]:
        style.SetColor(0, 0, 0)
        style.SetFontSize(24)
        style.ShadowOff()
        style.ItalicOff()
        style.BoldOff()
    bar.SetPosition(0.05, 0.15)
    bar.SetWidth(0.7)
    bar.SetHeight(0.7)
    legend.AddViewProp(bar)
    window.AddRenderer(legend)
    window.Render()
    picture = vtk.vtkWindowToImageFilter()
    picture.SetInput(window)
    picture.ReadFrontBufferOff()
    writer = vtk.vtkPNGWriter()
    writer.SetFileName(figure)
    writer.SetInputConnection(picture.GetOutputPort())
    writer.Write()


main()
