model KeywordAsName
  Real end = 3;
end KeywordAsName;
