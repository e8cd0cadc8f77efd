// Glass cylinder, radius 0.1 m, height 0.1 m, upright and centred on the origin: tetrahedra, or hexahedra with -setnumber hexahedra 1.
// The centre of the top face is a mesh vertex: the impact point. Cells grow from `near` there to `far`, m; `layers` of them, each 1.25 times as high as
// the one above, are across the height.
DefineConstant[ near = 0.005, far = 0.02, layers = 8, hexahedra = 0 ];
R = 0.1;
h = 0.1;
grow = 1.25;

SetFactory("OpenCASCADE");
Disk(1) = {0, 0, -h/2, R};
foot = newp;
Point(foot) = {0, 0, -h/2};
Point{foot} In Surface{1};

Field[1] = MathEval;
Field[1].F = Sprintf("%g + 0.35 * Sqrt(x * x + y * y)", near);
Field[2] = MathEval;
Field[2].F = Sprintf("%g", far);
Field[3] = Min;
Field[3].FieldsList = {1, 2};
Background Field = 3;
Mesh.CharacteristicLengthExtendFromBoundary = 0;
Mesh.CharacteristicLengthFromPoints = 0;

// From the bottom: how much of the height is below the end of each layer.
cells() = {};
below() = {};
For i In {1:layers}
  cells() += 1;
  below() += (1 - grow^(-i)) / (1 - grow^(-layers));
EndFor
If (hexahedra)
  Mesh.RecombinationAlgorithm = 2; // no triangle is left
  Recombine Surface{1};
  all() = Extrude {0, 0, h} { Surface{1}; Layers{ {cells()}, {below()} }; Recombine; };
Else
  all() = Extrude {0, 0, h} { Surface{1}; Layers{ {cells()}, {below()} }; };
EndIf
Physical Surface("bottom") = {1};
Physical Surface("top") = {all(0)};
Physical Surface("side") = {all({2:#all() - 1})};
Physical Volume("cylinder") = {all(1)};
Mesh.ElementOrder = 1;
