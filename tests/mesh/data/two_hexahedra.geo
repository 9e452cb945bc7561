// Two hexahedra, 1 x 1 x 2, in two volumes; the meshes beside this file were made by
// Gmsh 4.8 with:  gmsh -3 [-bin] -format msh22|msh41 two_hexahedra.geo
Point(1) = {0, 0, 0}; Point(2) = {1, 0, 0}; Point(3) = {1, 1, 0}; Point(4) = {0, 1, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4}; Plane Surface(1) = {1};
Transfinite Curve{1, 2, 3, 4} = 2; Transfinite Surface{1}; Recombine Surface{1};
lower[] = Extrude {0, 0, 1} { Surface{1}; Layers{1}; Recombine; };
upper[] = Extrude {0, 0, 1} { Surface{lower[0]}; Layers{1}; Recombine; };
Physical Volume("soft tissue") = {lower[1]};
Physical Volume("body") = {lower[1], upper[1]};
Physical Surface("clamped") = {1};
Physical Surface(7) = {upper[0]};
Physical Point("corner") = {3};
