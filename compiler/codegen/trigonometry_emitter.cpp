#include "compiler/codegen/trigonometry_emitter.h"

#include "compiler/codegen/math_library.h"
#include "lang/base/trigonometry.h"

#include <llvm/IR/IRBuilder.h>
#include <llvm/IR/MDBuilder.h>

namespace tf::codegen {

namespace {

class Emitter {
public:
  explicit Emitter(llvm::Function *function)
      : function_(function), builder_(llvm::BasicBlock::Create(function->getContext(), "entry", function)), angle_(function->getArg(0)) {}

  void emit() {
    constexpr std::uint32_t usual = 1000;
    llvm::LLVMContext &context = function_->getContext();
    llvm::BasicBlock *reduced = llvm::BasicBlock::Create(context, "reduced", function_);
    llvm::BasicBlock *other = llvm::BasicBlock::Create(context, "other", function_);
    llvm::Value *size = builder_.CreateUnaryIntrinsic(llvm::Intrinsic::fabs, angle_);
    builder_.CreateCondBr(builder_.CreateFCmpOLT(size, number(largestReducedAngle)), reduced, other,
                          llvm::MDBuilder(context).createBranchWeights(usual, 1));
    builder_.SetInsertPoint(reduced);
    emitReduced();
    builder_.SetInsertPoint(other);
    llvm::Module &module = *function_->getParent();
    give(builder_.CreateCall(mathFunction(module, "sin", 1), angle_), builder_.CreateCall(mathFunction(module, "cos", 1), angle_));
  }

private:
  using V = llvm::Value *;

  V number(double value) { return llvm::ConstantFP::get(builder_.getDoubleTy(), value); }
  V add(V a, V b) { return builder_.CreateFAdd(a, b); }
  V sub(V a, V b) { return builder_.CreateFSub(a, b); }
  V mul(V a, V b) { return builder_.CreateFMul(a, b); }

  V fma(V a, V b, V c) { return builder_.CreateIntrinsic(llvm::Intrinsic::fma, {builder_.getDoubleTy()}, {a, b, c}); }

  void give(V sine, V cosine) {
    V both = llvm::PoisonValue::get(function_->getReturnType());
    both = builder_.CreateInsertValue(both, sine, 0);
    builder_.CreateRet(builder_.CreateInsertValue(both, cosine, 1));
  }

  // `bits` with the sign changed where bit 1 of the quadrant is set.
  V signedBy(V quadrant, V bits) {
    constexpr std::uint64_t bit = 2, shift = 62;
    V sign = builder_.CreateShl(builder_.CreateAnd(quadrant, builder_.getInt64(bit)), builder_.getInt64(shift));
    return builder_.CreateBitCast(builder_.CreateXor(bits, sign), builder_.getDoubleTy());
  }

  // Exchanged in odd quadrants, without a branch that the processor would have to guess.
  void giveIn(V quadrant, V sine, V cosine) {
    V sineBits = builder_.CreateBitCast(sine, builder_.getInt64Ty()), cosineBits = builder_.CreateBitCast(cosine, builder_.getInt64Ty());
    V isOdd = builder_.CreateNeg(builder_.CreateAnd(quadrant, builder_.getInt64(1)));
    V change = builder_.CreateAnd(builder_.CreateXor(sineBits, cosineBits), isOdd);
    V next = builder_.CreateAdd(quadrant, builder_.getInt64(1));
    give(signedBy(quadrant, builder_.CreateXor(sineBits, change)), signedBy(next, builder_.CreateXor(cosineBits, change)));
  }

  void emitReduced() {
    V shifted = fma(angle_, number(twoOverPi), number(integerShift)), k = sub(shifted, number(integerShift)), back = builder_.CreateFNeg(k);
    V quadrant = builder_.CreateBitCast(shifted, builder_.getInt64Ty());
    const auto part = [&](int i) { return number(partsOfHalfPi[i]); };
    const auto s = [&](int i) { return number(sineCoefficients[i]); };
    const auto c = [&](int i) { return number(cosineCoefficients[i]); };
    V rest = fma(back, part(0), angle_), x = fma(back, part(1), rest);
    V y = fma(back, part(2), fma(back, part(1), sub(rest, x)));

    V z = mul(x, x), square = mul(z, z), half = mul(z, number(0.5));
    V high = fma(square, fma(square, s(5), fma(z, s(4), s(3))), fma(z, s(2), s(1)));
    V inner = fma(builder_.CreateFNeg(z), high, number(-sineCoefficients[0]));
    V sine = sub(x, fma(mul(z, x), inner, sub(mul(half, y), y)));
    V even = fma(square, fma(square, fma(z, c(5), c(4)), fma(z, c(3), c(2))), fma(z, c(1), c(0)));
    V most = sub(number(1), half);
    V cosine = add(most, fma(square, even, sub(sub(sub(number(1), most), half), mul(x, y))));
    giveIn(quadrant, sine, cosine);
  }

  llvm::Function *function_;
  llvm::IRBuilder<> builder_;
  llvm::Value *angle_;
};

}  // namespace

llvm::Function *sineAndCosineFunction(llvm::Module &module) {
  constexpr const char *name = "sine.cosine";
  if (llvm::Function *known = module.getFunction(name))
    return known;
  llvm::Type *real = llvm::Type::getDoubleTy(module.getContext());
  auto *type = llvm::FunctionType::get(llvm::StructType::get(real, real), {real}, false);
  llvm::Function *function = llvm::Function::Create(type, llvm::Function::InternalLinkage, name, module);
  function->setDoesNotAccessMemory();
  function->setDoesNotThrow();
  function->setWillReturn();
  for (const auto attribute : {llvm::Attribute::NoInline, llvm::Attribute::NoFree, llvm::Attribute::NoSync})
    function->addFnAttr(attribute);
  function->addFnAttr("tune-cpu", "generic");
  Emitter(function).emit();
  return function;
}

}  // namespace tf::codegen
