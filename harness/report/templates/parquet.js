// A table as an Apache Parquet file: one row group, a page a column, nothing compressed; numbers are DOUBLE, texts UTF8, and
// null stands for what is missing. After https://parquet.apache.org/docs/file-format/ and the compact protocol of Thrift.
const parquet = (columns, count) => {
  const I32 = 5, I64 = 6, BINARY = 8, LIST = 9, STRUCT = 12, DOUBLE = 5, BYTE_ARRAY = 6, PLAIN = 0, RLE = 3, OPTIONAL = 1, UTF8 = 0;
  const encoded = (text) => new TextEncoder().encode(text);
  const varint = (number) => {
    const bytes = [];
    for (; number >= 128; number = Math.floor(number / 128)) bytes.push((number % 128) + 128);
    return [...bytes, number];
  };
  // values of Thrift, as bytes; an integer here is never negative, and its zigzag code is twice itself
  const whole = (number) => varint(2 * number);
  const binary = (text) => { const bytes = encoded(text); return [...varint(bytes.length), ...bytes]; };
  const list = (kind, items) => [...(items.length < 15 ? [16 * items.length + kind] : [240 + kind, ...varint(items.length)]), ...items.flat()];
  const struct = (...fields) => {
    let last = 0;
    return [...fields.flatMap(([id, kind, bytes]) => { const step = id - last; last = id; return [16 * step + kind, ...bytes]; }), 0];
  };
  const little = (number) => [0, 8, 16, 24].map((shift) => (number >>> shift) & 255);

  const body = (column) => {
    const present = new Uint8Array(Math.ceil(count / 8));
    column.values.forEach((value, place) => { if (value !== null) present[place >> 3] |= 1 << (place & 7); });
    const levels = [...varint(2 * present.length + 1), ...present];
    const bytes = [...little(levels.length), ...levels];
    for (const value of column.values) {
      if (value === null) continue;
      if (column.numeric) bytes.push(...new Uint8Array(Float64Array.of(value).buffer));
      else { const text = encoded(value); bytes.push(...little(text.length), ...text); }
    }
    return bytes;
  };
  const file = [...encoded("PAR1")];
  const chunks = columns.map((column) => {
    const data = body(column), start = file.length;
    const about = struct([1, I32, whole(count)], [2, I32, whole(PLAIN)], [3, I32, whole(RLE)], [4, I32, whole(RLE)]);
    const header = struct([1, I32, whole(0)], [2, I32, whole(data.length)], [3, I32, whole(data.length)], [5, STRUCT, about]);
    for (const byte of header) file.push(byte);
    for (const byte of data) file.push(byte);
    const size = file.length - start, kind = column.numeric ? DOUBLE : BYTE_ARRAY;
    const meta = struct(
      [1, I32, whole(kind)], [2, LIST, list(I32, [whole(PLAIN), whole(RLE)])], [3, LIST, list(BINARY, [binary(column.name)])], [4, I32, whole(0)],
      [5, I64, whole(count)], [6, I64, whole(size)], [7, I64, whole(size)], [9, I64, whole(start)],
    );
    return { size, bytes: struct([2, I64, whole(start)], [3, STRUCT, meta]) };
  });
  const leaf = ({ name, numeric }) => struct(
    [1, I32, whole(numeric ? DOUBLE : BYTE_ARRAY)], [3, I32, whole(OPTIONAL)], [4, BINARY, binary(name)], ...(numeric ? [] : [[6, I32, whole(UTF8)]]),
  );
  const root = struct([4, BINARY, binary("schema")], [5, I32, whole(columns.length)]);
  const total = chunks.reduce((sum, chunk) => sum + chunk.size, 0);
  const group = struct([1, LIST, list(STRUCT, chunks.map((chunk) => chunk.bytes))], [2, I64, whole(total)], [3, I64, whole(count)]);
  const footer = struct(
    [1, I32, whole(1)], [2, LIST, list(STRUCT, [root, ...columns.map(leaf)])], [3, I64, whole(count)], [4, LIST, list(STRUCT, [group])], [6, BINARY, binary("harness")],
  );
  return Uint8Array.from([...file, ...footer, ...little(footer.length), ...encoded("PAR1")]);
};
