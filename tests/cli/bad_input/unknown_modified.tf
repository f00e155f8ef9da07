model UnknownModified
  coordinate Real q[2](start = {0, 1});
  body ball(mas = 1, position = q);
end UnknownModified;
