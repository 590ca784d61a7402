"""Converts the networks of the webcam tracker from TensorFlow.js to ONNX, which OpenCV reads.

    webcam_models.py MODEL.json MODEL.onnx

Written for BlazeFace, Face Mesh and Iris of MediaPipe. It refuses operations that these do not have. Tensors become
channels first, and the padding "SAME", which may be uneven, becomes a layer of its own. ONNX 1.6, operation set 11.
"""
import base64
import json
import math
import os
import struct
import sys


# Protocol buffers: a message is a list of fields (number, value).
def varint(value):
    value &= (1 << 64) - 1
    out = bytearray()
    while value > 127:
        out.append(value & 127 | 128)
        value >>= 7
    return bytes(out) + bytes([value])


def field(number, value):
    if isinstance(value, int):
        return varint(number << 3) + varint(value)
    if isinstance(value, float):
        return varint(number << 3 | 5) + struct.pack("<f", value)
    data = value.encode() if isinstance(value, str) else value
    return varint(number << 3 | 2) + varint(len(data)) + data


def message(*fields):
    return b"".join(field(number, value) for number, value in fields)


def tensor(name, shape, data):
    """data: bytes of float32, or a list of int64."""
    kind = 1 if isinstance(data, bytes) else 7
    raw = data if kind == 1 else struct.pack(f"<{len(data)}q", *data)
    return message(*((1, size) for size in shape), (2, kind), (8, name), (9, raw))


def value_info(name, shape):
    dims = message(*((1, message((1, size))) for size in shape))
    return message((1, name), (2, message((1, message((1, 1), (2, dims))))))


def attribute(name, value):
    if isinstance(value, int):
        return message((1, name), (3, value), (20, 2))
    return message((1, name), *((8, each) for each in value), (20, 7))


def permuted(values, shape, order):
    """The values of a dense array whose axes are put into this order."""
    strides = [math.prod(shape[axis + 1:]) for axis in range(len(shape))]
    at = [0]
    for axis in order:
        at = [begin + i * strides[axis] for begin in at for i in range(shape[axis])]
    return [values[i] for i in at]


class Graph:
    def __init__(self, model, folder):
        self.nodes, self.weights, self.shapes = [], {}, {}
        self.parts = []  # operations and constants of the ONNX graph
        self.constants = []
        manifest = model["weightsManifest"]
        for group in manifest:
            data = b"".join(open(os.path.join(folder, path), "rb").read() for path in group["paths"])
            at = 0
            for entry in group["weights"]:
                count = math.prod(entry["shape"])
                stored = entry.get("quantization", {}).get("dtype", entry["dtype"])
                letter = {"float32": "f", "float16": "e", "int32": "i"}.get(stored)
                if letter is None:
                    sys.exit(f"webcam_models.py: weights of type {stored}: expected float32, float16 or int32")
                size = struct.calcsize(letter) * count
                self.weights[entry["name"]] = (struct.unpack(f"<{count}{letter}", data[at:at + size]), entry["shape"])
                at += size
            if at != len(data):
                sys.exit(f"webcam_models.py: {len(data)} bytes of weights: expected {at}")
        self.nodes = model["modelTopology"]["node"]

    def constant(self, name, shape, values):
        data = values if values and isinstance(values[0], int) else struct.pack(f"<{len(values)}f", *values)
        self.constants.append(tensor(name, shape, data))
        return name

    def add(self, operation, inputs, output, shape, **attributes):
        self.shapes[output] = shape
        self.parts.append(message(*((1, each) for each in inputs), (2, output), (4, operation),
                                  *((5, attribute(name, value)) for name, value in attributes.items())))
        return output

    def pad(self, source, pads, output):
        shape = [size + pads[i] + pads[i + 4] for i, size in enumerate(self.shapes[source])]
        return self.add("Pad", [source, self.constant(output + ":pads", [8], pads)], output, shape)

    def convolution(self, node, name, inputs):
        values, (height, width, channels, count) = self.weights[inputs[1]]
        depthwise = node["op"] == "DepthwiseConv2dNative"
        order, group = ([2, 3, 0, 1], channels) if depthwise else ([3, 2, 0, 1], 1)
        outputs = channels * count if depthwise else count
        weights = self.constant(name + ":weights", [outputs, 1 if depthwise else channels, height, width],
                                permuted(values, [height, width, channels, count], order))
        fused = [base64.b64decode(each).decode()
                 for each in node["attr"].get("fused_ops", {}).get("list", {}).get("s", [])]
        if fused not in ([], ["BiasAdd"], ["BiasAdd", "Relu"], ["BiasAdd", "Prelu"]):
            sys.exit(f"webcam_models.py: {name}: fused operations {fused}: not known")
        source, step = self.spatial(node, name, inputs[0], (height, width))
        _, _, rows, columns = self.shapes[source]
        shape = [1, outputs, (rows - height) // step + 1, (columns - width) // step + 1]
        bias = [self.constant(name + ":bias", [outputs], self.weights[inputs[2]][0])] if fused else []
        last = len(fused) < 2
        self.add("Conv", [source, weights] + bias, name if last else name + ":linear", shape,
                 kernel_shape=[height, width], strides=[step, step], group=group)
        if fused[1:] == ["Relu"]:
            self.add("Relu", [name + ":linear"], name, shape)
        elif fused[1:] == ["Prelu"]:
            self.prelu(name, name + ":linear", inputs[3])

    def spatial(self, node, name, source, window):
        """The input with the padding "SAME" in rows and columns, and the step."""
        step = int(node["attr"]["strides"]["list"]["i"][1])
        if base64.b64decode(node["attr"]["padding"]["s"]) == b"VALID":
            return source, step
        rows, columns = (max((-(-size // step) - 1) * step + side - size, 0)
                         for size, side in zip(self.shapes[source][2:], window))
        pads = [0, 0, rows // 2, columns // 2, 0, 0, rows - rows // 2, columns - columns // 2]
        return (self.pad(source, pads, name + ":padded") if any(pads) else source), step

    def prelu(self, name, source, slope):
        values, _ = self.weights[slope]
        slope = self.constant(name + ":slope", [len(values), 1, 1], values)
        self.add("PRelu", [source, slope], name, self.shapes[source])

    def convert(self, node):
        name, operation = node["name"], node["op"]
        inputs = [each.split(":")[0] for each in node.get("input", [])]
        if operation == "Placeholder":
            rows, columns, channels = (int(each["size"]) for each in node["attr"]["shape"]["shape"]["dim"][1:])
            self.shapes[name] = [1, channels, rows, columns]
        elif operation in ("_FusedConv2D", "DepthwiseConv2dNative"):
            self.convolution(node, name, inputs)
        elif operation == "MaxPool":
            side = int(node["attr"]["ksize"]["list"]["i"][1])
            source, step = self.spatial(node, name, inputs[0], (side, side))
            _, channels, rows, columns = self.shapes[source]
            self.add("MaxPool", [source], name, [1, channels, (rows - side) // step + 1, (columns - side) // step + 1],
                     kernel_shape=[side, side], strides=[step, step])
        elif operation == "Prelu":
            self.prelu(name, inputs[0], inputs[1])
        elif operation == "Pad":
            pads, _ = self.weights[inputs[1]]  # begin and end of each axis, channels last
            self.pad(inputs[0], [pads[2 * axis + end] for end in (0, 1) for axis in (0, 3, 1, 2)], name)
        elif operation in ("Relu", "Sigmoid", "Identity"):
            self.add(operation, inputs, name, self.shapes[inputs[0]])
        elif operation == "AddV2":
            self.add("Add", inputs, name, self.shapes[inputs[0]])
        elif operation in ("Reshape", "ConcatV2"):
            self.flatten(name, inputs)
        else:
            sys.exit(f"webcam_models.py: operation {operation} is not known")

    def flatten(self, name, inputs):
        """Outputs count channels last. Iris joins its two. The last input is the shape, or the axis."""
        flat = []
        for source in inputs[:-1]:
            shape = self.shapes[source]
            if len(shape) == 4 and shape[2] * shape[3] > 1:
                source = self.add("Transpose", [source], f"{name}:last:{source}",
                                  [shape[0], shape[2], shape[3], shape[1]], perm=[0, 2, 3, 1])
            size = [1, math.prod(shape)]
            sizes = self.constant(f"{name}:size:{source}", [2], size)
            flat.append(self.add("Reshape", [source, sizes], f"{name}:flat:{source}", size))
        total = [1, sum(self.shapes[each][1] for each in flat)]
        if len(flat) > 1:
            self.add("Concat", flat, name, total, axis=1)
        else:
            self.add("Identity", flat, name, total)

    def in_order(self):
        """Each node after its inputs."""
        by_name = {node["name"]: node for node in self.nodes if node["op"] != "Const"}
        done, order = set(), []

        def visit(name):
            if name in done or name not in by_name:
                return
            done.add(name)
            for each in by_name[name].get("input", []):
                visit(each.split(":")[0])
            order.append(by_name[name])

        for name in by_name:
            visit(name)
        return order

    def onnx(self, outputs):
        source = next(node["name"] for node in self.nodes if node["op"] == "Placeholder")
        for node in self.in_order():
            self.convert(node)
        for name, of in outputs.items():
            self.add("Identity", [of], name, self.shapes[of])
        graph = message(*((1, part) for part in self.parts), (2, "graph"), *((5, each) for each in self.constants),
                        (11, value_info(source, self.shapes[source])),
                        *((12, value_info(name, self.shapes[name])) for name in outputs))
        return message((1, 6), (7, graph), (8, message((1, ""), (2, 11))))


def outputs_of(nodes):
    """Final nodes by the name of what they pass on: `regressors_1`, `output_mesh`, ..."""
    finals = [node for node in nodes if node["op"] == "Identity"]
    names = {}
    for node in finals:
        parts = node["input"][0].split("/")
        names[next((part for part in parts if part.startswith("output_")), parts[-1])] = node["name"]
    return names


def main():
    sys.setrecursionlimit(10000)
    if len(sys.argv) != 3:
        sys.exit("usage: webcam_models.py MODEL.json MODEL.onnx")
    with open(sys.argv[1], encoding="utf-8") as file:
        model = json.load(file)
    graph = Graph(model, os.path.dirname(sys.argv[1]))
    data = graph.onnx(outputs_of(graph.nodes))
    with open(sys.argv[2] + ".part", "wb") as file:
        file.write(data)
    os.replace(sys.argv[2] + ".part", sys.argv[2])


main()
