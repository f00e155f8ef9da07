model SubscriptOutOfRange
  coordinate Real q[2](start = {0, 1});
  body ball(mass = 1, position = q);
  Real x = q[3];
end SubscriptOutOfRange;
