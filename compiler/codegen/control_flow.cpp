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

void whereTrue(llvm::IRBuilder<> &builder, llvm::Value *condition, const std::function<void()> &body) {
  llvm::Function *function = builder.GetInsertBlock()->getParent();
  llvm::BasicBlock *taken = llvm::BasicBlock::Create(builder.getContext(), "taken", function);
  llvm::BasicBlock *next = llvm::BasicBlock::Create(builder.getContext(), "next", function);
  builder.CreateCondBr(condition, taken, next);
  builder.SetInsertPoint(taken);
  body();
  builder.CreateBr(next);
  builder.SetInsertPoint(next);
}

}  // namespace tf::codegen
