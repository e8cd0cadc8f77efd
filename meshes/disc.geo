// Round glass plate, radius 0.25 m, thickness 0.02 m, centred on the origin, hexahedra.
// A core of four blocks and a ring of eight, extruded through the thickness.
// The centre of the top face is a mesh vertex: the impact point.
R = 0.25;
h = 0.02;
corner = 0.11;  // distance of the core's corners from the axis
middle = 0.09;  // distance of the middle of the core's sides from the axis
n_core = 4;     // cells along each side of a core block, and along each eighth of the rim
n_ring = 6;     // cells from the core to the rim
n_thick = 2;    // cells through the thickness
grow = 0.95;    // ratio of neighbouring cells, from the core to the rim

Point(1) = {0, 0, -h/2};
For i In {0:3}
  t = i * Pi/2;
  Point(10 + i) = {middle * Cos(t), middle * Sin(t), -h/2};
  Point(20 + i) = {corner * Cos(t + Pi/4), corner * Sin(t + Pi/4), -h/2};
  Point(30 + i) = {R * Cos(t), R * Sin(t), -h/2};
  Point(40 + i) = {R * Cos(t + Pi/4), R * Sin(t + Pi/4), -h/2};
EndFor

For i In {0:3}
  j = (i + 1) % 4;
  Line(10 + i) = {1, 10 + i};
  Line(20 + i) = {10 + i, 20 + i};
  Line(30 + i) = {20 + i, 10 + j};
  Line(40 + i) = {10 + i, 30 + i};
  Line(50 + i) = {20 + i, 40 + i};
  Circle(60 + i) = {30 + i, 1, 40 + i};
  Circle(70 + i) = {40 + i, 1, 30 + j};
EndFor
Transfinite Curve{10:13, 20:23, 30:33, 60:63, 70:73} = n_core + 1;
Transfinite Curve{40:43, 50:53} = n_ring + 1 Using Progression grow;

For i In {0:3}
  j = (i + 1) % 4;
  Curve Loop(10 + i) = {10 + i, 20 + i, 30 + i, -(10 + j)};     Plane Surface(10 + i) = {10 + i};
  Curve Loop(20 + i) = {40 + i, 60 + i, -(50 + i), -(20 + i)};  Plane Surface(20 + i) = {20 + i};
  Curve Loop(30 + i) = {50 + i, 70 + i, -(40 + j), -(30 + i)};  Plane Surface(30 + i) = {30 + i};
EndFor
bottom[] = {10:13, 20:23, 30:33};
Transfinite Surface{bottom[]};
Recombine Surface{bottom[]};

// Each block is extruded to its lid (entry 0), its volume (1) and its walls (2 to 5, in the
// order of the curve loop): the rim is the second wall of the ring's blocks.
top[] = {};
disc[] = {};
rim[] = {};
For n In {0:#bottom[] - 1}
  e[] = Extrude {0, 0, h} { Surface{bottom[n]}; Layers{n_thick}; Recombine; };
  top[] += e[0];
  disc[] += e[1];
  If (bottom[n] >= 20)
    rim[] += e[3];
  EndIf
EndFor

Physical Surface("rim") = {rim[]};
Physical Surface("top") = {top[]};
Physical Surface("bottom") = {bottom[]};
Physical Volume("disc") = {disc[]};
Mesh.ElementOrder = 1;
