// A half ring of hexahedra for gmsh-sling.json, in millimetres. Made with
//   gmsh -3 -format msh41 gmsh-sling.geo -o gmsh-sling.msh
inner = 300; outer = 450; width = 120;
across = 4; along = 16; layers = 4;  // elements: across, per quarter, along z

Point(1) = {0, 0, 0};
Point(2) = {-outer, 0, 0};  Point(3) = {-inner, 0, 0};
Point(4) = {0, -outer, 0};  Point(5) = {0, -inner, 0};
Point(6) = {outer, 0, 0};   Point(7) = {inner, 0, 0};
Circle(1) = {2, 1, 4};  Circle(2) = {4, 1, 6};
Circle(3) = {3, 1, 5};  Circle(4) = {5, 1, 7};
Line(5) = {2, 3};  Line(6) = {4, 5};  Line(7) = {6, 7};

Curve Loop(1) = {5, 3, -6, -1};  Plane Surface(1) = {1};
Curve Loop(2) = {6, 4, -7, -2};  Plane Surface(2) = {2};
Transfinite Curve {5, 6, 7} = across + 1;
Transfinite Curve {1, 2, 3, 4} = along + 1;
Transfinite Surface {1, 2};
Recombine Surface {1, 2};

left[] = Extrude {0, 0, width} { Surface{1}; Layers{layers}; Recombine; };
right[] = Extrude {0, 0, width} { Surface{2}; Layers{layers}; Recombine; };
Physical Volume("sling") = {left[1], right[1]};
Physical Surface("left end") = {left[2]};
Physical Surface("right end") = {right[4]};
