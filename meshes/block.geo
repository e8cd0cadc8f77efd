// Unit cube, centred on the origin: the small meshes for tests of the reader.
// One geometry, meshed as tetrahedra, or (-setnumber hexahedra 1) with each tetrahedron
// split into four hexahedra, which are unstructured and distorted in all directions.
DefineConstant[ hexahedra = 0 ];

Point(1) = {-0.5, -0.5, -0.5};
Point(2) = { 0.5, -0.5, -0.5};
Point(3) = { 0.5,  0.5, -0.5};
Point(4) = {-0.5,  0.5, -0.5};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
e[] = Extrude {0, 0, 1} { Surface{1}; };

Physical Surface("side") = {e[2], e[3], e[4], e[5]};
Physical Surface("top") = {e[0]};
Physical Surface("bottom") = {1};
Physical Volume("block") = {e[1]};

Mesh.CharacteristicLengthMin = 1;
Mesh.CharacteristicLengthMax = 1;
Mesh.ElementOrder = 1;
If (hexahedra)
  Mesh.SubdivisionAlgorithm = 2;
EndIf
