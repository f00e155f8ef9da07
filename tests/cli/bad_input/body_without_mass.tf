model BodyWithoutMass
  coordinate Real q[2];
  body ball(position = q);
end BodyWithoutMass;
