// Glass plate 0.5 x 0.5 x 0.02 m, centred on the origin, tetrahedra.
// The centre of the top face is a mesh vertex: the impact point.
// Cells grow from `near` at the impact point to `far` at the edges.
L = 0.5;
h = 0.02;
near = 0.004;
far = 0.04;
reach = 0.12; // distance from the impact point at which cells have grown to `far`

Point(1) = {-L/2, -L/2, -h/2};
Point(2) = { L/2, -L/2, -h/2};
Point(3) = { L/2,  L/2, -h/2};
Point(4) = {-L/2,  L/2, -h/2};
Point(5) = {-L/2, -L/2,  h/2};
Point(6) = { L/2, -L/2,  h/2};
Point(7) = { L/2,  L/2,  h/2};
Point(8) = {-L/2,  L/2,  h/2};
Point(9) = {0, 0, h/2};

Line(1) = {1, 2};  Line(2) = {2, 3};  Line(3) = {3, 4};  Line(4) = {4, 1};
Line(5) = {5, 6};  Line(6) = {6, 7};  Line(7) = {7, 8};  Line(8) = {8, 5};
Line(9) = {1, 5};  Line(10) = {2, 6}; Line(11) = {3, 7}; Line(12) = {4, 8};

Curve Loop(1) = {-4, -3, -2, -1};   Plane Surface(1) = {1}; // bottom
Curve Loop(2) = {5, 6, 7, 8};       Plane Surface(2) = {2}; // top
Curve Loop(3) = {1, 10, -5, -9};    Plane Surface(3) = {3};
Curve Loop(4) = {2, 11, -6, -10};   Plane Surface(4) = {4};
Curve Loop(5) = {3, 12, -7, -11};   Plane Surface(5) = {5};
Curve Loop(6) = {4, 9, -8, -12};    Plane Surface(6) = {6};
Point{9} In Surface{2};
Surface Loop(1) = {1, 2, 3, 4, 5, 6};
Volume(1) = {1};

Physical Surface("side") = {3, 4, 5, 6};
Physical Surface("top") = {2};
Physical Surface("bottom") = {1};
Physical Volume("plate") = {1};

Field[1] = Distance;
Field[1].NodesList = {9};
Field[2] = Threshold;
Field[2].IField = 1;
Field[2].LcMin = near;
Field[2].LcMax = far;
Field[2].DistMin = 0.5 * h;
Field[2].DistMax = reach;
Background Field = 2;
Mesh.CharacteristicLengthExtendFromBoundary = 0;
Mesh.CharacteristicLengthFromPoints = 0;
Mesh.Optimize = 1;
Mesh.ElementOrder = 1;
