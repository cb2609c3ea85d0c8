// gram_reduce.cl - adds the partial sums of the Gram matrices over the runs of a launch (gram.cl, gram_gpu.cl)
//   sums[slot][lane] = (high, low): high + low is the compensated sum (Neumaier) of the rows of a slot
//
// NDRange  global {blocks * 16, slots}, local {16, 1}
// Buffers  partial    in   [row][blocks * 16] float
//          row_begin  in   [slot + 1] int   first entry of a slot in rows
//          rows       in   [entry] int      rows of a slot, in rising run order
//          sums       out  [slot][blocks * 16] float2
// Sums     fixed order; the error stays that of the parts, however many runs there are

kernel void gram_reduce(global const float* partial, global const int* row_begin, global const int* rows,
                        global float2* sums) {
  const ulong lane = get_global_id(0);
  const ulong lanes = get_global_size(0);
  const ulong slot = get_global_id(1);
  float high = 0.0f;
  float low = 0.0f;
  for (int i = row_begin[slot]; i < row_begin[slot + 1]; ++i) {
    const float value = partial[(ulong)rows[i] * lanes + lane];
    const float sum = high + value;
    low += fabs(high) >= fabs(value) ? (high - sum) + value : (value - sum) + high;
    high = sum;
  }
  sums[slot * lanes + lane] = (float2)(high, low);
}
