package TF "the library of mechanical models"
end TF;
