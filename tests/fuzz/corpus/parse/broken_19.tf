model 3D
  Real x;
end 3D;
model C
  Real x
end C;
