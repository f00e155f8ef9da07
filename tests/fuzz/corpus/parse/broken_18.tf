x = 1;
model A end A;
foo bar;
within B;
model B end B;
