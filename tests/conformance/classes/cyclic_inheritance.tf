// expect: TF0218 at 3:7
// model: A
model A
  extends B;
end A;
model B
  extends A;
end B;
