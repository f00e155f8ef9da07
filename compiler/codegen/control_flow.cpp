#include "compiler/codegen/control_flow.h"

namespace tf::codegen {

void countedLoop(llvm::IRBuilder<> &builder, llvm::Value *begin, llvm::Value *end, const std::function<void(llvm::Value *)> &body) {
  steppingLoop(builder, begin, end, [&](llvm::Value *index) -> llvm::Value * {
    body(index);
    return builder.getInt32(1);
  });
}

void steppingLoop(llvm::IRBuilder<> &builder, llvm::Value *begin, llvm::Value *end,
                  const std::function<llvm::Value *(llvm::Value *)> &body) {
  llvm::Function *function = builder.GetInsertBlock()->getParent();
  llvm::LLVMContext &context = builder.getContext();
  llvm::BasicBlock *before = builder.GetInsertBlock();
  llvm::BasicBlock *head = llvm::BasicBlock::Create(context, "head", function);
  llvm::BasicBlock *inside = llvm::BasicBlock::Create(context, "body", function);
  llvm::BasicBlock *after = llvm::BasicBlock::Create(context, "after", function);
  builder.CreateBr(head);
  builder.SetInsertPoint(head);
  llvm::PHINode *index = builder.CreatePHI(builder.getInt32Ty(), 2, "k");
  index->addIncoming(begin, before);
  builder.CreateCondBr(builder.CreateICmpSLT(index, end), inside, after);
  builder.SetInsertPoint(inside);
  llvm::Value *step = body(index);
  index->addIncoming(builder.CreateNSWAdd(index, step), builder.GetInsertBlock());
  builder.CreateBr(head);
  builder.SetInsertPoint(after);
}

namespace {

llvm::BasicBlock *newBlock(llvm::IRBuilder<> &builder, const char *name) {
  return llvm::BasicBlock::Create(builder.getContext(), name, builder.GetInsertBlock()->getParent());
}

void fill(llvm::IRBuilder<> &builder, llvm::BasicBlock *block, const std::function<void()> &body, llvm::BasicBlock *next) {
  builder.SetInsertPoint(block);
  body();
  builder.CreateBr(next);
}

}  // namespace

void whereTrue(llvm::IRBuilder<> &builder, llvm::Value *condition, const std::function<void()> &body) {
  llvm::BasicBlock *taken = newBlock(builder, "taken"), *next = newBlock(builder, "next");
  builder.CreateCondBr(condition, taken, next);
  fill(builder, taken, body, next);
  builder.SetInsertPoint(next);
}

void chooseByTruth(llvm::IRBuilder<> &builder, llvm::Value *condition, const std::function<void()> &yes, const std::function<void()> &no) {
  llvm::BasicBlock *taken = newBlock(builder, "taken"), *other = newBlock(builder, "other"), *next = newBlock(builder, "next");
  builder.CreateCondBr(condition, taken, other);
  fill(builder, taken, yes, next);
  fill(builder, other, no, next);
  builder.SetInsertPoint(next);
}

}  // namespace tf::codegen
