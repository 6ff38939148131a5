# Moves this node with the gel, in Godot 3. Start first: neurotouch stream websocket
extends Spatial

var socket := WebSocketClient.new()


func _ready() -> void:
	socket.connect("data_received", self, "_take")
	socket.connect_to_url("ws://127.0.0.1:8765")


func _process(_delta: float) -> void:
	socket.poll()


func _take() -> void:
	var text := socket.get_peer(1).get_packet().get_string_from_utf8()
	var touch: Dictionary = JSON.parse(text).result
	# A push moves, a twist turns, pinch and zoom scale.
	translation = Vector3(touch.moved_mm[0], 0.0, touch.moved_mm[1]) * 0.1
	rotation = Vector3(0.0, -touch.turned_rad, 0.0)
	scale = Vector3.ONE * max(touch.scale, 0.1)
