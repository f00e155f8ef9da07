model EqualInExpression
  Real x = if time = 1 then 2 else 3;
end EqualInExpression;
