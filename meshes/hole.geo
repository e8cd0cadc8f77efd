// Round glass plate, radius 0.5 m, thickness 0.02 m, with a hole, centred on the origin: tetrahedra, or hexahedra with -setnumber hexahedra 1.
// The centre of the top face is a mesh vertex: the impact point. Cells grow from `near` there to `far`, m; `layers` of them are across the plate.
DefineConstant[ near = 0.0025, far = 0.04, layers = 4, hexahedra = 0 ];
R = 0.5;
h = 0.02;
r = 0.1;  // of the hole
x = 0.25; // of its axis

SetFactory("OpenCASCADE");
Disk(1) = {0, 0, -h/2, R};
Disk(2) = {x, 0, -h/2, r};
bottom() = BooleanDifference{ Surface{1}; Delete; }{ Surface{2}; Delete; };
foot = newp;
Point(foot) = {0, 0, -h/2};
Point{foot} In Surface{bottom(0)};

Field[1] = MathEval;
Field[1].F = Sprintf("%g + 0.35 * Sqrt(x * x + y * y)", near);
Field[2] = MathEval;
Field[2].F = Sprintf("%g", far);
Field[3] = Min;
Field[3].FieldsList = {1, 2};
Background Field = 3;
Mesh.CharacteristicLengthExtendFromBoundary = 0;
Mesh.CharacteristicLengthFromPoints = 0;

If (hexahedra)
  Mesh.RecombinationAlgorithm = 2; // no triangle is left
  Recombine Surface{bottom()};
  all() = Extrude {0, 0, h} { Surface{bottom()}; Layers{layers}; Recombine; };
Else
  all() = Extrude {0, 0, h} { Surface{bottom()}; Layers{layers}; };
EndIf
Physical Surface("bottom") = {bottom()};
Physical Surface("top") = {all(0)};
Physical Surface("side") = {all({2:#all() - 1})};
Physical Volume("plate") = {all(1)};
Mesh.ElementOrder = 1;
