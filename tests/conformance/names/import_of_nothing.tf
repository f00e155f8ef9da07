// expect: TF0202 at 4:10
// expect: TF0202 at 5:14
model ImportOfNothing "what an import that leads nowhere would have given is not reported again"
  import Foundry.Steel;
  import W = Foundry.Wood;
  coordinate Real y(start = Steel.height);
  body b(mass = W.density, position = y);
end ImportOfNothing;
